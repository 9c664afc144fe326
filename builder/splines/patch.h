#pragma once

// Surface patches as height fields over a plane, from scattered points or the rings around a mesh vertex.
//
// This work is based on:
// F. Cazals, M. Pouget. Estimating differential quantities using polynomial fitting of osculating jets. 2003
// M. do Carmo. Differential Geometry of Curves and Surfaces, section 3.3. 1976

#include <span>
#include <vector>

#include "builder/splines/polyharmonic.h"
#include "geometry/connectivity.h"
#include "geometry/mesh.h"

namespace fascia::splines {

struct PatchOptions {
  int rings = 2;         ///< of vertices around the one in the middle
  double exponent = 4;   ///< below 4 curvatures at data points are not finite (r^2 ln r) or jump (r^3)
  double lambda = 0;     ///< smoothing, see SplineOptions
  bool normals = false;  ///< the mesh's vertex normals as gradient constraints
  int jet_degree = 0;    ///< 2 to 4: a polynomial of this degree by least squares, not a spline
};

/// Curvatures of the graph, positive where it bends towards the patch's normal (a bowl); a sphere seen from
/// outside has both at -1/R.
struct PatchCurvature {
  double gaussian = 0, mean = 0;
  double smallest = 0, largest = 0;                                          ///< principal curvatures
  Vec3 smallest_direction = Vec3::Zero(), largest_direction = Vec3::Zero();  ///< unit, in space
};

/// The point of a patch nearest to a query point: where a growing sphere about it first touches.
struct PatchFoot {
  Vec2 uv = Vec2::Zero();
  Vec3 position = Vec3::Zero();
  double distance = 0;
  bool converged = false;
};

/// A surface z(u, v) over the plane through `origin` spanned by the first two columns of `frame`; the third
/// is its normal.
class Patch {
 public:
  Patch(const Vec3& origin, const Mat3& frame, Spline height);

  const Vec3& origin() const { return origin_; }
  const Mat3& frame() const { return frame_; }
  const Spline& height() const { return height_; }

  /// Plane coordinates of the foot of `point`.
  Vec2 coordinates(const Vec3& point) const;
  Vec3 position(const Vec2& uv) const;
  Vec3 normal(const Vec2& uv) const;
  PatchCurvature curvature(const Vec2& uv) const;

  /// Newton steps on (p - s) . s_u = (p - s) . s_v = 0 from the foot in the plane; steps that do not lessen
  /// the distance are shortened.
  PatchFoot project(const Vec3& point) const;

 private:
  Vec3 origin_;
  Mat3 frame_;
  Spline height_;
};

/// Patch through `points` over the plane at `origin` with `normal`; `normals` is empty or gives the surface
/// normal at each point as a gradient constraint. Throws Error for fewer than six points, points above each
/// other, or a normal that leans 80 degrees or more from the plane's.
Patch fit_patch(std::span<const Vec3> points, std::span<const Vec3> normals, const Vec3& origin,
                const Vec3& normal, const PatchOptions& options = {});

/// Vertices at most `rings` edges away from `vertex`, itself first, then ring by ring.
std::vector<int> vertex_rings(const TriangleMesh& mesh, const Connectivity& links, int vertex, int rings);

/// Patch through the rings around `vertex`, in the frame of its area-weighted normal. Rings that fold over in
/// that frame are left off; rings are added until there are six points. Throws Error when the mesh around the
/// vertex has too few vertices or folds over in its first ring.
Patch vertex_patch(const TriangleMesh& mesh, const Connectivity& links, int vertex,
                   const PatchOptions& options = {});

}  // namespace fascia::splines
