#include "builder/rigging/shared_vertices.h"

#include <gtest/gtest.h>

namespace fascia::rigging {
namespace {

/// Two primitives of one mesh over four vertices: the first draws 0, 1 and 2, the second 1, 2 and 3 (or,
/// apart, its own).
formats::Scene scene_of(bool shared) {
  formats::Scene scene;
  for (int p = 0; p < 2; ++p) {
    formats::SceneMesh mesh;
    mesh.mesh = 5;
    mesh.primitive = p;
    mesh.positions = {Vec3(0, 0, 0), Vec3(1, 0, 0), Vec3(0, 1, 0), Vec3(1, 1, 0), Vec3(9, 9, shared ? 9 : p)};
    mesh.triangles = {p == 0 ? Triangle{0, 1, 2} : Triangle{1, 3, 2}};
    scene.meshes.push_back(mesh);
  }
  return scene;
}

std::vector<rig::Binding> bindings() {
  std::vector<rig::Binding> list;
  for (uint32_t p = 0; p < 2; ++p) {
    rig::Binding binding;
    binding.mesh = 5;
    binding.primitive = p;
    binding.influences = 2;
    binding.nodes.assign(10, p + 1);
    binding.weights.assign(10, 0.5F);
    binding.jaw_weights.assign(5, static_cast<float>(p));
    binding.eye.assign(5, static_cast<uint8_t>(p));
    list.push_back(binding);
  }
  return list;
}

TEST(SharedVertices, EachVertexFollowsAsThePrimitiveThatDrawsIt) {
  std::vector<rig::Binding> list = bindings();
  share_vertices(scene_of(true), list);
  for (const rig::Binding& binding : list) {
    EXPECT_EQ(binding.nodes, (std::vector<uint32_t>{1, 1, 1, 1, 1, 1, 2, 2, 0, 0}));
    EXPECT_EQ(binding.weights, (std::vector<float>{0.5F, 0.5F, 0.5F, 0.5F, 0.5F, 0.5F, 0.5F, 0.5F, 0, 0}));
    EXPECT_EQ(binding.jaw_weights, (std::vector<float>{0, 0, 0, 1, 0}));
    EXPECT_EQ(binding.eye, (std::vector<uint8_t>{0, 0, 0, 1, 0}));
  }
}

TEST(SharedVertices, BuffersOfTheirOwnStayApart) {
  std::vector<rig::Binding> list = bindings();
  share_vertices(scene_of(false), list);
  EXPECT_EQ(list[0].nodes, bindings()[0].nodes);
  EXPECT_EQ(list[1].nodes, bindings()[1].nodes);
}

}  // namespace
}  // namespace fascia::rigging
