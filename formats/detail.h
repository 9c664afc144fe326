#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "formats/scene.h"

/// The readers of the formats; `formats::read` chooses among them.
namespace fascia::formats::detail {

void read_gltf(Scene& scene, const std::vector<uint8_t>& bytes, const ReadOptions& options);
void read_obj(Scene& scene);
void read_ply(Scene& scene);
void read_stl(Scene& scene);

/// Triangles of a polygon, convex or not: quads along their shorter diagonal, others by ear clipping.
void triangulate(const std::vector<Vec3>& positions, const std::vector<int>& polygon,
                 std::vector<Triangle>& triangles);

/// Whether a transform is a reflection, which inverts the orientation of every triangle.
inline bool is_mirroring(const Mat4& transform) {
  const auto linear = transform.topLeftCorner<3, 3>();
  return linear.col(0).cross(linear.col(1)).dot(linear.col(2)) < 0.0;
}

[[noreturn]] void fail(const Scene& scene, const std::string& what);

}  // namespace fascia::formats::detail
