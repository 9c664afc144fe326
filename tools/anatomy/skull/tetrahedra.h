#pragma once

#include "builder/smas/implicit_function.h"
#include "geometry/mesh.h"

namespace fascia::skull_maker {

/// The part of the zero set of `field` that reaches farthest up, within `reach` of `points` and at
/// x > -2 `cell`: by marching tetrahedra over cubes of side `cell` cut in six, so that it is a manifold
/// whatever the field does. Sheets of a single cell's thickness and creases survive.
TriangleMesh march_tetrahedra(const smas::ImplicitFunction& field, const std::vector<Vec3>& points,
                              double reach, double cell);

}  // namespace fascia::skull_maker
