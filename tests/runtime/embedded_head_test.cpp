// The runtime's interface on a whole face: the rig of the embedded head, FASCIA_EMBEDDED_RIG
// (samples.capture_files).
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>

#include "tests/runtime/skinned_rig.h"

namespace {

using namespace fascia::test;

std::vector<uint8_t> embedded_rig() {
  const char* const path = std::getenv("FASCIA_EMBEDDED_RIG");
  std::ifstream stream(path != nullptr ? path : "", std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// What is shown of a mesh, in metres.
fascia_vectors positions_of(fascia_face* face, uint32_t mesh) {
  fascia_vectors vectors = {};
  vectors.struct_size = sizeof vectors;
  EXPECT_EQ(fascia_face_positions(face, mesh, &vectors), FASCIA_OK) << fascia_last_message();
  return vectors;
}

TEST(EmbeddedHeadRuntime, SkinningReproducesTheVerticesOfEveryMesh) {
  const std::vector<uint8_t> bytes = embedded_rig();
  if (bytes.empty()) GTEST_SKIP() << "FASCIA_EMBEDDED_RIG is not there";
  const Loaded rig(bytes);
  const Face face(rig.asset);
  for (const char* name : {"arkit:jawOpen", "arkit:mouthSmileLeft", "arkit:browInnerUp",
                           "arkit:eyeLookUpLeft", "arkit:cheekPuff", "arkit:mouthPucker"})
    ASSERT_EQ(fascia_face_set(face.face, name, 0.6F), FASCIA_OK) << fascia_last_message();
  ASSERT_EQ(fascia_face_pose(face.face), FASCIA_OK);
  fascia_asset_info info = {};
  info.struct_size = sizeof info;
  ASSERT_EQ(fascia_asset_get_info(rig.asset, &info), FASCIA_OK);
  ASSERT_GT(info.mesh_count, 2U);  // skin, eyes, teeth
  double moved = 0.0;
  for (uint32_t mesh = 0; mesh < info.mesh_count; ++mesh) {
    const Skinned data(face.face, mesh);
    const fascia_vectors shown = positions_of(face.face, mesh);
    ASSERT_EQ(data.skinning.vertex_count, shown.count);
    EXPECT_LT(data.error(shown.data), 1e-5) << mesh;
    for (std::size_t i = 0; i < std::size_t{3} * shown.count; ++i)
      moved = std::max(moved, static_cast<double>(std::abs(shown.data[i] - data.skinning.rest[i])));
  }
  EXPECT_GT(moved, 5e-3);
}

TEST(EmbeddedHeadRuntime, CompressionOfOneMeshStaysInPlaceWhileOthersAreAskedFor) {
  const std::vector<uint8_t> bytes = embedded_rig();
  if (bytes.empty()) GTEST_SKIP() << "FASCIA_EMBEDDED_RIG is not there";
  const Loaded rig(bytes);
  const Face face(rig.asset);
  ASSERT_EQ(fascia_face_set(face.face, "arkit:mouthPucker", 0.6F), FASCIA_OK);
  ASSERT_EQ(fascia_face_pose(face.face), FASCIA_OK);
  fascia_vectors first = {};
  first.struct_size = sizeof first;
  fascia_vectors other = first, again = first;
  ASSERT_EQ(fascia_face_compression(face.face, 1, &first), FASCIA_OK);
  const std::vector<float> before(first.data, first.data + std::size_t{3} * first.count);
  ASSERT_EQ(fascia_face_compression(face.face, 0, &other), FASCIA_OK);
  EXPECT_NE(first.data, other.data);
  EXPECT_EQ(before, std::vector<float>(first.data, first.data + std::size_t{3} * first.count));
  ASSERT_EQ(fascia_face_compression(face.face, 1, &again), FASCIA_OK);
  EXPECT_EQ(first.data, again.data);
}

TEST(EmbeddedHeadRuntime, RotationsOfTheEyesReplaceTheirLookShapes) {
  const std::vector<uint8_t> bytes = embedded_rig();
  if (bytes.empty()) GTEST_SKIP() << "FASCIA_EMBEDDED_RIG is not there";
  const Loaded rig(bytes);
  const auto played = [&](const std::string& csv, const char* channel) {
    fascia_curves* curves = nullptr;
    EXPECT_EQ(fascia_curves_load(csv.data(), csv.size(), &curves), FASCIA_OK) << fascia_last_message();
    const Face face(rig.asset);
    EXPECT_EQ(fascia_curves_apply(curves, 0.0, 1.0F, face.face), FASCIA_OK);
    EXPECT_EQ(fascia_face_pose(face.face), FASCIA_OK);
    const float value =
        fascia_face_effective_values(face.face)[fascia_asset_find_channel(rig.asset, channel)];
    fascia_curves_release(curves);
    return value;
  };
  // Both say where an eye looks: their sum would turn it twice. ARKit's yaw is positive to the subject's
  // left, its pitch downward; the rig's upward.
  const std::string both = "time,EyeLookDownLeft,EyeLookOutLeft,LeftEyePitch,LeftEyeYaw\n0,1,1,0.1,0.25\n";
  EXPECT_FLOAT_EQ(played(both, "eye_pitch_left"), -0.1F);
  EXPECT_FLOAT_EQ(played(both, "eye_yaw_left"), 0.25F);
  EXPECT_EQ(played(both, "eye_pitch_right"), 0.0F);
  const std::string shapes = "time,EyeLookDownLeft,EyeLookOutLeft\n0,1,1\n";
  EXPECT_FLOAT_EQ(played(shapes, "eye_pitch_left"), -0.42F);
  EXPECT_GT(played(shapes, "eye_yaw_left"), 0.3F);
}

}  // namespace
