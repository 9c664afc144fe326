#pragma once

#include <functional>

#include "builder/smas/implicit_function.h"
#include "geometry/mesh.h"
#include "tools/anatomy/skull/crests.h"

namespace fascia::skull_maker {

struct SymmetricMeshOptions {
  double cell = 1.5;           ///< of the grid that the surface is first found on
  double reach = 7.0;          ///< how far from `points` the surface may lie
  double largest_edge = 9.0;   ///< where the surface is flat
  double smallest_edge = 2.6;  ///< where it bends
  int triangles = 6200;        ///< of the whole, roughly: sets how far the normal turns along an edge
  int passes = 5;              ///< of split, collapse, flip and smooth, three times
  std::vector<Rim> rims;       ///< lines of the left half that edges follow
  double rim_edge = 2.0;       ///< along the rims
  double growth = 0.55;        ///< how fast edges may grow from place to place
  CreaseOptions creases;
  /// By how much larger the triangles may be at a place; none: 1 everywhere.
  std::function<double(const Vec3&)> coarseness;
};

/// Meshes the closed surface of `field`, which must be symmetric about x = 0 and run near `points`: the
/// left half up to the midplane with triangles sized by curvature, welded to its own mirror image.
/// Exactly symmetric and closed. Throws Error when the halves do not meet in a manifold.
TriangleMesh symmetric_mesh(const smas::ImplicitFunction& field, const std::vector<Vec3>& points,
                            const SymmetricMeshOptions& options = {});

/// The point of the surface of `field` that Newton steps from `point` reach; with `in_midplane`, within x =
/// 0. Where the field is not a number, `point` itself.
Vec3 on_surface(const smas::ImplicitFunction& field, Vec3 point, bool in_midplane);

/// `half` (x >= 0) and its mirror image as one mesh: vertices at x = 0 are shared, vertex i of the half
/// stays vertex i.
TriangleMesh mirrored(const TriangleMesh& half);

}  // namespace fascia::skull_maker
