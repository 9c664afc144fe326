#pragma once

#include <string>
#include <vector>

#include "formats/scene.h"

/// One reader a format; `formats::read` chooses among them.
namespace fascia::formats::detail {

void read_gltf(Scene& scene, const std::vector<uint8_t>& bytes, const ReadOptions& options);
void read_obj(Scene& scene);
void read_ply(Scene& scene);
void read_stl(Scene& scene);

/// Triangles of a polygon, convex or not: quads along their shorter diagonal, others by their ears.
void triangulate(const std::vector<Vec3>& positions, const std::vector<int>& polygon,
                 std::vector<Triangle>& triangles);

[[noreturn]] void fail(const Scene& scene, const std::string& what);

}  // namespace fascia::formats::detail
