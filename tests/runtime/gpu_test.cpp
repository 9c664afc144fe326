#include "fascia/gpu.h"

#include <gtest/gtest.h>

#include <vector>

#include "tests/runtime/skinned_rig.h"

namespace {

using namespace fascia::test;

TEST(Deltas, AreTheDisplacementsFromRest) {
  const Loaded rig;
  const Face face(rig.asset, FASCIA_SPACE_MESH);
  const std::vector<float> rest = face.positions();
  std::vector<float> deltas(rest.size());
  float scale = -1.0F;
  ASSERT_EQ(
      fascia_face_write_deltas(face.face, 0, FASCIA_DELTA_FLOAT32, deltas.data(), 12, side * side, &scale),
      FASCIA_OK);
  EXPECT_EQ(scale, 0.0F);
  fascia_face_values(face.face)[0] = 0.9F;
  fascia_face_pose(face.face);
  const std::vector<float> posed = face.positions();
  ASSERT_EQ(
      fascia_face_write_deltas(face.face, 0, FASCIA_DELTA_FLOAT32, deltas.data(), 12, side * side, &scale),
      FASCIA_OK);
  std::vector<int16_t> small(4 * static_cast<std::size_t>(side * side), 77);
  ASSERT_EQ(
      fascia_face_write_deltas(face.face, 0, FASCIA_DELTA_SNORM16, small.data(), 8, side * side, &scale),
      FASCIA_OK);
  float largest = 0.0F;
  for (std::size_t v = 0; v < side * side; ++v) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(deltas[3 * v + axis], posed[3 * v + axis] - rest[3 * v + axis]);
      EXPECT_NEAR(scale * static_cast<float>(small[4 * v + axis]) / 32767.0F, deltas[3 * v + axis],
                  scale / 65000.0F);
      largest = std::max(largest, std::abs(deltas[3 * v + axis]));
    }
    EXPECT_EQ(small[4 * v + 3], 0);
  }
  EXPECT_EQ(scale, largest);
  EXPECT_EQ(fascia_face_write_deltas(face.face, 0, FASCIA_DELTA_SNORM16, small.data(), 8, 3, &scale),
            FASCIA_ERROR_ARGUMENT);
  EXPECT_EQ(fascia_face_write_deltas(face.face, 0, FASCIA_DELTA_SNORM16, small.data(), 4, 999, &scale),
            FASCIA_ERROR_ARGUMENT);
}

/// What skinning.glsl does, in C++: the formula of fascia/gpu.h.
TEST(Skinning, ReproducesTheVertices) {
  const Loaded rig(rig_with_bones());
  for (const fascia_space space : {FASCIA_SPACE_MESH, FASCIA_SPACE_INPUT, FASCIA_SPACE_METRES}) {
    const Face face(rig.asset, space);
    drive_everything(face.face);
    const Skinned data(face.face);
    const double worst = data.error(face.positions().data());
    EXPECT_LT(worst, space == FASCIA_SPACE_METRES ? 1e-6 : 1e-4);  // centimetres: 1e-6 m
  }
}

TEST(Skinning, RejectsMismatchedInput) {
  const Loaded rig;
  const Face face(rig.asset);
  float texel[4] = {};
  EXPECT_EQ(fascia_face_write_node_texture(face.face, 0, texel, 1), FASCIA_ERROR_ARGUMENT);
  EXPECT_EQ(fascia_face_bone_matrices(face.face, 3, nullptr), FASCIA_ERROR_ARGUMENT);
  fascia_skinning skinning = {};
  EXPECT_EQ(fascia_face_skinning(face.face, 0, &skinning), FASCIA_ERROR_ARGUMENT);
}

}  // namespace
