#pragma once

#include <string>
#include <vector>

#include "builder/geodesics/path.h"
#include "builder/spatial/surface_query.h"

namespace fascia::muscles {

/// A surface with what fibres need of it: geodesics, closest points, and reused memory. Not shared
/// between threads.
struct Carrier {
  const geodesics::Surface& surface;
  const spatial::SurfaceQuery& query;
  geodesics::Workspace workspace;
  geodesics::Path path;

  /// The geodesic between two points, in `path` until the next call.
  const geodesics::Path& connect(const SurfacePoint& from, const SurfacePoint& to);
  SurfacePoint closest(const Vec3& point) const { return query.closest(point).surface; }
  Vec3 at(const SurfacePoint& point) const { return position(surface.mesh, point); }
  Vec3 normal(const SurfacePoint& point) const { return query.smooth_normal(point); }
};

/// Unit direction in which `path` leaves its start (or its end, going back); zero for a path of no length.
Vec3 direction_at_start(const geodesics::Path& path);
Vec3 direction_at_end(const geodesics::Path& path);

/// Indices of the corners of the convex hull of `points` in the plane, counter-clockwise (Andrew's monotone
/// chain); points in line with two corners are left out.
std::vector<int> planar_hull(const std::vector<Vec2>& points);

/// A geodesically convex polygon: corners counter-clockwise seen from outside.
struct Hull {
  std::vector<SurfacePoint> corners;
  std::vector<Vec3> positions;  ///< of the corners, metres
  std::vector<Vec3> onward;     ///< unit direction of the side to the next corner, at each corner
  std::vector<Vec3> backward;   ///< unit direction of the side to the corner before
  std::vector<double> sides;    ///< length to the next corner, metres
  double turning = 0.0;         ///< sum of the outer angles, radians: 2π less the curvature enclosed
  double kept = 1.0;            ///< share of the region's extent that the hull is of; below 1 when shrunk
  int size() const { return static_cast<int>(corners.size()); }
  /// The mean of the corners.
  Vec3 middle() const;
};

/// z of the cross product of two vectors of the plane.
inline double cross(const Vec2& a, const Vec2& b) {
  return a[0] * b[1] - a[1] * b[0];
}

/// The geodesic convex hull of `points` on the carrier (thesis section 7.2.2): the planar hull in
/// geodesic polar coordinates about their middle, then corners that are reflex between the geodesics to
/// their neighbours removed and points left outside a side taken in, until neither is found. Points
/// nearer than `merge` metres count as one; of one or two distinct points the hull is these.
/// A region that covers half a closed surface or more has no hull: it is drawn in towards its middle until
/// it has one, and `Hull::kept` says by how much. Throws `Error` naming `what` when there are no points, or
/// when they lie on parts of the surface that are not connected.
Hull geodesic_hull(Carrier& carrier, const std::vector<SurfacePoint>& points, const std::string& what,
                   double merge = 1e-5);

}  // namespace fascia::muscles
