#pragma once

#include "builder/smas/implicit_function.h"
#include "builder/smas/surface_mesh.h"

namespace fascia::smas {

/// The surface that a mesh is to stay on, and how it is found.
struct SurfaceField {
  const ImplicitFunction& function;
  double tolerance;  ///< distance at which projection stops
  long evaluations = 0;

  /// Moves `point` to the surface by Newton steps of at most `reach`, and sets `normal` to the gradient's
  /// direction. False, changing nothing, when the surface is not found within two reaches, or faces away from
  /// `normal`.
  bool project(Vec3* point, Vec3* normal, double reach);
};

/// Splits edges longer than 4/3 of the length asked for.
void split_long_edges(SurfaceField* field, SurfaceMesh* mesh);

/// Collapses edges shorter than 2/3 of the length asked for, and vertices of three or four triangles, but
/// none across a larger turn of the normal than `feature_turn`, radians. Returns whether there were any.
bool collapse_short_edges(double feature_turn, SurfaceMesh* mesh);

/// Collapses the shortest edges of triangles inside the mesh with an angle below `least_angle`, radians,
/// where nothing folds or flattens. Returns the old numbers of the vertices that stay, all of them when there
/// was none.
std::vector<int> collapse_slivers(double least_angle, SurfaceMesh* mesh);

/// Flips edges to larger smallest angles.
void flip_edges(double feature_turn, SurfaceMesh* mesh);

}  // namespace fascia::smas
