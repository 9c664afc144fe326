#pragma once

// Closest points, rays and inside tests against a triangle surface.
//
// This work is based on:
// J. Baerentzen, H. Aanaes. Signed distance computation using the angle weighted pseudonormal. 2005
// A. Jacobson, L. Kavan, O. Sorkine-Hornung. Robust inside-outside segmentation using generalized winding
// numbers. 2013

#include <limits>
#include <memory>
#include <optional>
#include <vector>

#include "geometry/mesh.h"

namespace fascia::spatial {

/// The point of a surface that is closest to a query point.
struct ClosestPoint {
  SurfacePoint surface;                                       ///< triangle -1 when nothing is in range
  Vec3 position = Vec3::Zero();                               ///< where, in the mesh's unit
  double distance = std::numeric_limits<double>::infinity();  ///< unsigned
  Vec3 pseudonormal = Vec3::Zero();  ///< unit outward normal of the face, edge or vertex hit
  double signed_distance = std::numeric_limits<double>::infinity();  ///< negative inside
  bool found() const { return surface.triangle >= 0; }
};

/// Where a ray meets a surface.
struct RayHit {
  SurfacePoint surface;
  Vec3 position = Vec3::Zero();
  double distance = 0;       ///< along the unit direction
  bool from_outside = true;  ///< the ray runs against the triangle's normal
};

/// Queries against one immutable triangle mesh. Embree finds the triangles in single precision; every
/// number returned is computed from the mesh's doubles. Ties go to the lowest triangle, so answers do not
/// depend on threads. Copies share the same structure; const members may be called from many threads.
///
/// Vertices at the same position count as one, so texture seams leave no cracks in the sign.
class SurfaceQuery {
 public:
  /// Throws Error when the mesh has no triangles, or coordinates or indices that are not usable.
  explicit SurfaceQuery(TriangleMesh mesh);

  const TriangleMesh& mesh() const;

  /// The closest point within `range`.
  ClosestPoint closest(const Vec3& point, double range = std::numeric_limits<double>::infinity()) const;

  /// The same without the side it lies on: pseudonormal and signed distance are left as they are. For few
  /// queries of a large mesh, whose normals are then not needed.
  ClosestPoint nearest_place(const Vec3& point, double range = std::numeric_limits<double>::infinity()) const;

  /// Distance to the surface, negative inside, by the angle-weighted pseudonormal. On an open surface the
  /// sign is that of the side of the nearest patch.
  double signed_distance(const Vec3& point) const { return closest(point).signed_distance; }

  /// First hit of the ray from `origin` along `direction` (any length but 0) between `nearest` and `range`.
  std::optional<RayHit> first_hit(const Vec3& origin, const Vec3& direction,
                                  double range = std::numeric_limits<double>::infinity(),
                                  double nearest = 0) const;

  /// True when the ray meets anything within `range`; faster than first_hit.
  bool blocked(const Vec3& origin, const Vec3& direction,
               double range = std::numeric_limits<double>::infinity()) const;

  /// All hits in order of distance; hits on shared edges may appear once for each triangle.
  std::vector<RayHit> all_hits(const Vec3& origin, const Vec3& direction,
                               double range = std::numeric_limits<double>::infinity()) const;

  /// Generalised winding number: 1 inside, 0 outside of a closed surface, in between near openings.
  /// Linear in the number of triangles.
  double winding_number(const Vec3& point) const;

  /// Inside by winding number > 1/2: right also for surfaces with openings such as a neck cut.
  bool inside(const Vec3& point) const { return winding_number(point) > 0.5; }

  /// Unit normal interpolated from the angle-weighted vertex normals.
  Vec3 smooth_normal(const SurfacePoint& surface) const;

 private:
  struct State;
  std::shared_ptr<const State> state_;
};

}  // namespace fascia::spatial
