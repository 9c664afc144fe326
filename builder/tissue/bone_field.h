#pragma once

#include <array>
#include <vector>

#include "geometry/mesh.h"

namespace fascia::tissue {

/// Signed distances to a bone with its teeth on a regular grid, negative inside.
struct BoneField {
  Vec3 origin = Vec3::Zero();      ///< metres, of the first value
  double spacing = 0.0;            ///< metres
  std::array<uint32_t, 3> size{};  ///< values along x, y and z
  std::vector<float> distance;     ///< metres, x fastest; clamped to +-reach

  size_t index(size_t i, size_t j, size_t k) const { return i + size[0] * (j + size[1] * k); }
};

/// Samples the signed distance to `bone` (metres) over `box`, up to `reach` metres from its surface. Bones
/// are often open or intersect themselves (a row of crowns without roots), and the sign by normals then jumps
/// in mid-air; the field is made continuous: of two neighbours that differ by more than their distance, the
/// one outside is believed, so that such places lose contact instead of throwing what passes them.
BoneField sample_bone_field(const TriangleMesh& bone, const Bounds& box, double spacing, double reach);

}  // namespace fascia::tissue
