#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "fascia/gpu.h"
#include "tests/runtime/loaded.h"

namespace fascia::test {

/// The tiny rig with some vertices on the jaw and some on the left eye.
inline std::vector<uint8_t> rig_with_bones() {
  rig::Rig rig = tiny_rig();
  rig::Binding& binding = rig.tissue.bindings[0][0];
  for (uint32_t v = 0; v < binding.vertex_count; ++v) {
    if (v < 60) binding.jaw_weights[v] = 1.0F - static_cast<float>(v) / 60.0F;
    if (v > 250) binding.eye[v] = 1;
  }
  return rig::write(tiny_head(), rig);
}

/// Muscles, jaw, cheek and eye at once.
inline void drive_everything(fascia_face* face) {
  const float values[5] = {0.9F, 0.2F, 0.6F, 0.5F, 0.4F};
  std::copy(values, values + 5, fascia_face_values(face));
  EXPECT_EQ(fascia_face_pose(face), FASCIA_OK) << fascia_last_message();
}

/// All that a vertex shader gets of a mesh.
struct Skinned {
  explicit Skinned(fascia_face* face, uint32_t mesh = 0) {
    skinning.struct_size = sizeof skinning;
    EXPECT_EQ(fascia_face_skinning(face, mesh, &skinning), FASCIA_OK) << fascia_last_message();
    nodes.resize(4 * std::size_t{skinning.node_count});
    EXPECT_EQ(fascia_face_write_node_texture(face, mesh, nodes.data(), skinning.node_count), FASCIA_OK);
    EXPECT_EQ(fascia_face_bone_matrices(face, mesh, bones), FASCIA_OK);
  }
  Eigen::Vector3f node(uint32_t index) const {
    return Eigen::Map<const Eigen::Vector3f>(nodes.data() + 4 * std::size_t{index});
  }
  Eigen::Vector3f bone(uint32_t index, const Eigen::Vector3f& place) const {
    const Eigen::Map<const Eigen::Matrix4f> matrix(bones + 16 * std::size_t{index});
    return (matrix * place.homogeneous()).head<3>();
  }
  /// Where a vertex is, by the formula of fascia/gpu.h, which skinning.glsl and .wgsl compute.
  Eigen::Vector3f place(uint32_t vertex) const {
    const Eigen::Vector3f rest = Eigen::Map<const Eigen::Vector3f>(skinning.rest + 3 * std::size_t{vertex});
    const uint32_t eye = skinning.eyes[vertex];
    if (eye != 0) return bone(eye, rest);
    Eigen::Vector3f at = rest + skinning.jaw[vertex] * (bone(0, rest) - rest);
    for (uint32_t i = 0; i < skinning.influences; ++i) {
      const std::size_t entry = std::size_t{vertex} * skinning.influences + i;
      at += skinning.weights[entry] * node(skinning.nodes[entry]);
    }
    return at;
  }
  /// The farthest that a vertex computed so is from the runtime's own.
  double error(const float* positions) const {
    double worst = 0.0;
    for (uint32_t v = 0; v < skinning.vertex_count; ++v)
      worst = std::max(
          worst, static_cast<double>(
                     (place(v) - Eigen::Map<const Eigen::Vector3f>(positions + 3 * std::size_t{v})).norm()));
    return worst;
  }
  fascia_skinning skinning = {};
  std::vector<float> nodes;
  float bones[48] = {};
};

}  // namespace fascia::test
