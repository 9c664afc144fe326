#pragma once

#include <vector>

#include "builder/smas/implicit_function.h"

namespace fascia::smas {

/// Shape of a mesh's triangles.
struct TriangleQuality {
  double min_angle = 0.0;          ///< Smallest angle of all, degrees.
  double mean_min_angle = 0.0;     ///< Mean over triangles of their smallest angle, degrees.
  double mean_radius_ratio = 0.0;  ///< Mean of 2 inradius / circumradius; 1 when equilateral.
};

/// Measures `mesh`; of no triangles, zeros.
TriangleQuality triangle_quality(const TriangleMesh& mesh);

/// How `improve_triangles` works.
struct QualityOptions {
  int passes = 4;           ///< Rounds of split, collapse, flip and smooth.
  double tolerance = 1e-8;  ///< Distance to the surface at which projection stops.
  double feature_turn =
      1.2;  ///< Edges are not flipped or collapsed across larger turns of the normal, radians.
  bool move_boundary = true;        ///< Even out boundary vertices along the boundary.
  double boundary_smoothing = 0.3;  ///< How far they move across it as well, from 0 to 1.
};

/// Makes the triangles of a surface mesh near equilateral without leaving the surface: splits edges
/// longer than 4/3 of the size asked for, collapses those shorter than 2/3, flips edges to larger
/// smallest angles, and moves vertices tangentially to the centre of their neighbours and back to the
/// surface by Newton steps.
///
/// @param function   the surface's implicit function
/// @param mesh       manifold mesh with vertices on the surface; changed in place
/// @param normals    one unit normal a vertex; kept up to date
/// @param sizes      edge length asked for at each vertex; kept up to date
/// @returns calls of the function
///
/// Based on: M. Botsch and L. Kobbelt, "A remeshing approach to multiresolution modeling", SGP 2004.
long improve_triangles(const ImplicitFunction& function, const QualityOptions& options, TriangleMesh* mesh,
                       std::vector<Vec3>* normals, std::vector<double>* sizes);

}  // namespace fascia::smas
