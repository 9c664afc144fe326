#pragma once

#include <vector>

#include "geometry/mesh.h"

namespace fascia::view {

/// For each vertex the first one that lies at the same place: vertices doubled at texture seams, at groups'
/// borders and at hard edges become one. `positions` at rest, before a pose pulls rounding apart.
std::vector<int> seams_of(const std::vector<Vec3>& positions);

/// Unit normals, one a vertex, weighted by angle (Thürmer & Wüthrich 1998, Computing vertex normals from
/// polygonal facets); vertices with the same entry in `seams` share theirs. Zero where nothing meets.
std::vector<Vec3> smooth_normals(const std::vector<Vec3>& positions, const std::vector<Triangle>& triangles,
                                 const std::vector<int>& seams);

}  // namespace fascia::view
