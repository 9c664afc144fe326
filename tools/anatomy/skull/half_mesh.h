#pragma once

#include "builder/smas/implicit_function.h"
#include "geometry/mesh.h"

namespace fascia::skull_maker {

struct SymmetricMeshOptions {
  double cell = 1.5;             ///< of the grid that the surface is first found on
  double reach = 7.0;            ///< how far from `points` the surface may lie
  double largest_edge = 9.0;     ///< where the surface is flat
  double smallest_edge = 2.6;    ///< where it bends
  int triangles = 6200;          ///< of the whole, roughly: sets how far the normal turns along an edge
  int passes = 14;               ///< of split, collapse, flip and smooth
};

/// Meshes the closed surface of `field`, which must be symmetric about x = 0 and run near `points`: the
/// left half up to the midplane with triangles sized by curvature, welded to its own mirror image.
/// Exactly symmetric and closed. Throws Error when the halves do not meet in a manifold.
TriangleMesh symmetric_mesh(const smas::ImplicitFunction& field, const std::vector<Vec3>& points,
                            const SymmetricMeshOptions& options = {});

/// `half` (x >= 0) and its mirror image as one mesh: vertices at x = 0 are shared, vertex i of the half
/// stays vertex i.
TriangleMesh mirrored(const TriangleMesh& half);

}  // namespace fascia::skull_maker
