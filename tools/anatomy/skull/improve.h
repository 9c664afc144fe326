#pragma once

#include <vector>

#include "builder/smas/surface_quality.h"

namespace fascia::skull_maker {

/// As smas::improve_triangles, but every pass decides on the mesh as it was when the pass began: on sheets of
/// bone thinner than an edge, where the figures were set by what comes out, it keeps the two faces apart.
/// Slower by far.
long improve(const smas::ImplicitFunction& function, const smas::QualityOptions& options, TriangleMesh* mesh,
             std::vector<Vec3>* normals, std::vector<double>* sizes);

}  // namespace fascia::skull_maker
