#pragma once

#include <vector>

#include "geometry/mesh.h"

namespace fascia::smas {

/// Cuts a mesh along the zero line of a field given at its vertices and keeps the part where the field is
/// positive. Vertices near the line move onto it instead of leaving slivers.
///
/// @param snap    part of an edge, from its end, within which the line takes the vertex along, < .5
/// @param mesh    changed in place; new vertices lie on the old edges
/// @param normals unit normals, @param sizes edge lengths asked for, @param field: one a vertex, kept up to
/// date
void trim(double snap, TriangleMesh* mesh, std::vector<Vec3>* normals, std::vector<double>* sizes,
          std::vector<double>* field);

/// Keeps the triangles with `keep` set and the vertices that they use; vertex data as in `trim`, of which
/// `field` may be anything.
void keep_triangles(const std::vector<bool>& keep, TriangleMesh* mesh, std::vector<Vec3>* normals,
                    std::vector<double>* sizes, std::vector<double>* field);

/// Keeps the part of a mesh that holds most triangles, joined by edges, and drops boundary triangles at
/// vertices where two stretches of the boundary meet; vertex data as in `trim`.
void keep_main_part(TriangleMesh* mesh, std::vector<Vec3>* normals, std::vector<double>* sizes,
                    std::vector<double>* field);

}  // namespace fascia::smas
