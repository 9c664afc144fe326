#pragma once

#include <vector>

#include "geometry/mesh.h"

namespace fascia::skull_maker {

/// Collapses the edges of `mesh` that are short for the `sizes` asked for at their ends, shortest first,
/// until none below `share` of its size can go. Keeps the topology (link condition), triangles within
/// 70 degrees of the surface's `normals`, and boundary vertices on the boundary; vertices stay where they
/// are. `sizes` has one length a vertex and is renumbered with the mesh.
void thin_out(double share, const std::vector<Vec3>& normals, TriangleMesh* mesh, std::vector<double>* sizes);

}  // namespace fascia::skull_maker
