#pragma once

#include <string>
#include <vector>

#include "geometry/mesh.h"

namespace fascia::geodesics {

/// A surface preprocessed for geodesics in O(n log n); immutable and safe to share between threads.
///
/// Half-edge `3*t+e` runs from corner `e` of triangle `t` to corner `(e+1)%3`, the triangle on its left. All
/// lengths and angles come from edge lengths alone, so a path depends on the surface's inner geometry only.
/// Degenerate triangles are treated by lengthening every edge by the same tiny amount (`mollification`,
/// metres; Sharp & Crane 2020, "A Laplacian for Nonmanifold Triangle Meshes", section 4.5), at most 1e-10 of
/// the mean edge length.
struct Surface {
  TriangleMesh mesh;
  /// The same edge in the neighbouring triangle, -1 at a boundary or a non-manifold edge.
  std::vector<int> twin;
  /// Where the third corner lies when the half-edge is laid from (0,0) to (1,0); its y is positive.
  std::vector<Vec2> apex;
  /// Length of each half-edge, metres.
  std::vector<double> length;
  /// Angle of the triangle at the half-edge's origin, radians.
  std::vector<double> angle;
  /// Connected component of each triangle, by shared edges.
  std::vector<int> piece;
  double mollification = 0.0;

  static int next(int half_edge) { return half_edge % 3 == 2 ? half_edge - 2 : half_edge + 1; }
  static int previous(int half_edge) { return half_edge % 3 == 0 ? half_edge + 2 : half_edge - 1; }
  int origin(int half_edge) const { return mesh.triangles[half_edge / 3][half_edge % 3]; }
  int target(int half_edge) const { return origin(next(half_edge)); }
  int opposite(int half_edge) const { return origin(previous(half_edge)); }
};

/// Builds the tables of `mesh`. Throws `Error` when the mesh has no triangle, an index out of range, a
/// triangle that repeats a vertex, or a coordinate that is not finite; `name` is what the message calls it.
Surface make_surface(TriangleMesh mesh, const std::string& name = "surface");

/// `point` with its weights clamped to the triangle, those below 1e-12 set to zero. Throws `Error`
/// when it is not on `surface`.
SurfacePoint checked(const Surface& surface, const SurfacePoint& point);

/// `point`, which lies on `half_edge`'s edge, expressed in the triangle across that edge.
SurfacePoint across(const Surface& surface, int half_edge, const SurfacePoint& point);

/// The point a share `fraction` of the way along `half_edge`, in the half-edge's own triangle.
SurfacePoint point_on_edge(int half_edge, double fraction);

/// Sum of the angles around vertex `vertex` seen from the corner at the origin of `half_edge`, by
/// turning through edge neighbours; `boundary` receives whether the turn is open.
double total_angle(const Surface& surface, int half_edge, bool* boundary = nullptr);

}  // namespace fascia::geodesics
