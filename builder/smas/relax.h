#pragma once

#include <functional>

#include "builder/smas/surface_edits.h"
#include "builder/smas/surface_mesh.h"

namespace fascia::smas {

/// How vertices of a boundary move.
struct BoundaryMotion {
  bool along = true;    ///< even out along the boundary
  double across = 0.3;  ///< how far they move across it as well, from 0 to 1
};

/// Moves every vertex to the centre of its triangles, as far as nothing folds or flattens, along the surface
/// as the turn of the normals foretells it.
void smooth_along_surface(const BoundaryMotion& boundary, SurfaceMesh* mesh);

/// Moves vertices of triangles with an angle below `least_angle`, radians, and of folded ones to wherever
/// nearby the smallest angle around them is largest. With `may_lie(vertex, point)` only to places where that
/// is true, off the surface too where that helps; it is last called with the place taken. Returns whether any
/// vertex moved.
bool relax_worst(const BoundaryMotion& boundary, double least_angle,
                 const std::function<bool(int, const Vec3&)>& may_lie, SurfaceMesh* mesh);

/// Moves all vertices onto the surface.
void settle(SurfaceField* field, SurfaceMesh* mesh);

}  // namespace fascia::smas
