#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <memory>
#include <string>
#include <thread>
#include <vector>

#include "tests/runtime/loaded.h"

namespace {

using namespace fascia::test;

TEST(FaceTest, AtRestNothingMovesInAnySpace) {
  const Loaded rig;
  for (const fascia_space space : {FASCIA_SPACE_MESH, FASCIA_SPACE_INPUT, FASCIA_SPACE_METRES}) {
    const Face face(rig.asset, space);
    const std::vector<float> before = face.positions();
    ASSERT_EQ(fascia_face_pose(face.face), FASCIA_OK);
    EXPECT_EQ(before, face.positions());
    for (int i = 0; i < 20; ++i)
      ASSERT_EQ(fascia_face_step(face.face, 1.0F / 60.0F), FASCIA_OK);
    EXPECT_EQ(before, face.positions());
  }
}

TEST(FaceTest, MeshSpaceIsTheFilesOwn) {
  const Loaded rig;
  const Face mesh(rig.asset, FASCIA_SPACE_MESH), input(rig.asset, FASCIA_SPACE_INPUT), metres(rig.asset);
  const std::vector<uint8_t> bin = fascia::test::tiny_head().bin;
  const std::vector<float> positions = mesh.positions();
  EXPECT_EQ(0, std::memcmp(positions.data(), bin.data(), positions.size() * 4));
  // The node stands 160 cm up; the rig is in metres.
  EXPECT_NEAR(input.positions()[1], positions[1] + 160.0F, 1e-3);
  EXPECT_NEAR(metres.positions()[1], 0.01F * positions[1] + 1.6F, 1e-5);
}

TEST(FaceTest, AMusclePullsItsSideUpAndOut) {
  const Loaded rig;
  const Face face(rig.asset);
  const std::vector<float> rest = face.positions();
  ASSERT_EQ(fascia_face_set(face.face, "Zygomaticus_Major_Left", 1.0F), FASCIA_OK);
  ASSERT_EQ(fascia_face_pose(face.face), FASCIA_OK);
  const std::vector<float> posed = face.positions();
  EXPECT_GT(left_corner(posed, 0) - left_corner(rest, 0), 1e-4F);
  EXPECT_GT(left_corner(posed, 1) - left_corner(rest, 1), 1e-4F);
  const float other = left_corner(posed, 1, -1) - left_corner(rest, 1, -1);
  EXPECT_LT(std::abs(other), 0.4F * (left_corner(posed, 1) - left_corner(rest, 1)));
  // The same motion in the mesh's centimetres.
  const Face centimetres(rig.asset, FASCIA_SPACE_MESH);
  const std::vector<float> cm_rest = centimetres.positions();
  fascia_face_values(centimetres.face)[0] = 1.0F;
  ASSERT_EQ(fascia_face_pose(centimetres.face), FASCIA_OK);
  EXPECT_NEAR(left_corner(centimetres.positions(), 1) - left_corner(cm_rest, 1),
              100.0F * (left_corner(posed, 1) - left_corner(rest, 1)), 2e-3F);
}

TEST(FaceTest, MembersAddUpAndAreClamped) {
  const Loaded rig;
  const Face face(rig.asset);
  ASSERT_EQ(fascia_face_set(face.face, "arkit:MOUTHsmileLeft", 0.5F), FASCIA_OK);
  ASSERT_EQ(fascia_face_set(face.face, "au:12", 0.25F), FASCIA_OK);
  ASSERT_EQ(fascia_face_set(face.face, "mouthSmileRight", 9.0F), FASCIA_OK);
  ASSERT_EQ(fascia_face_set(face.face, "zygomaticus_major_left", 0.1F), FASCIA_OK);
  ASSERT_EQ(fascia_face_pose(face.face), FASCIA_OK);
  const float* effective = fascia_face_effective_values(face.face);
  EXPECT_NEAR(effective[0], 0.1F + 0.9F * 0.5F + 0.8F * 0.15F, 1e-6F)
      << "the response of au:12 plays 0.15 of its row at 0.25";
  EXPECT_EQ(effective[1], 1.0F);
  float value = 0;
  ASSERT_EQ(fascia_face_get(face.face, "au:12", &value), FASCIA_OK);
  EXPECT_EQ(value, 0.25F);
  EXPECT_EQ(fascia_face_set(face.face, "arkit:noseGrow", 1), FASCIA_ERROR_NAME);
  EXPECT_NE(std::string(fascia_last_message()).find("noseGrow"), std::string::npos);
  EXPECT_EQ(fascia_face_set(face.face, "au:12", NAN), FASCIA_ERROR_ARGUMENT);
  ASSERT_EQ(fascia_face_clear(face.face), FASCIA_OK);
  ASSERT_EQ(fascia_face_pose(face.face), FASCIA_OK);
  EXPECT_EQ(fascia_face_effective_values(face.face)[0], 0.0F);
}

TEST(FaceTest, TimeArrivesAtThePose) {
  const Loaded rig;
  const Face still(rig.asset), moving(rig.asset);
  const std::vector<float> rest = still.positions();
  fascia_face_values(still.face)[0] = fascia_face_values(moving.face)[0] = 0.7F;
  ASSERT_EQ(fascia_face_pose(still.face), FASCIA_OK);
  for (int i = 0; i < 180; ++i)
    ASSERT_EQ(fascia_face_step(moving.face, 1.0F / 60.0F), FASCIA_OK) << fascia_last_message();
  const double motion = largest_motion(rest, still.positions());
  EXPECT_GT(motion, 3e-4);
  EXPECT_LT(largest_motion(moving.positions(), still.positions()), 0.05 * motion);
  // Back to rest at once.
  fascia_face_clear(moving.face);
  ASSERT_EQ(fascia_face_reset(moving.face), FASCIA_OK);
  EXPECT_EQ(moving.positions(), rest);
  EXPECT_EQ(fascia_face_step(moving.face, -1.0F), FASCIA_ERROR_ARGUMENT);
  EXPECT_EQ(fascia_face_step(moving.face, NAN), FASCIA_ERROR_ARGUMENT);
}

TEST(FaceTest, NonFiniteValuesAreIgnored) {
  const Loaded rig;
  const Face face(rig.asset);
  float* values = fascia_face_values(face.face);
  for (const float bad :
       {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), 1e30F}) {
    for (int c = 0; c < 5; ++c)
      values[c] = bad;
    for (int i = 0; i < 5; ++i)
      fascia_face_step(face.face, 1.0F / 30.0F);
    for (const float coordinate : face.positions())
      ASSERT_TRUE(std::isfinite(coordinate));
  }
}

TEST(FaceTest, NormalsAreUnitAndFollow) {
  const Loaded rig;
  const Face face(rig.asset);
  const std::vector<float> rest = face.normals();
  for (std::size_t v = 0; v < rest.size(); v += 3) {
    EXPECT_NEAR(rest[v] * rest[v] + rest[v + 1] * rest[v + 1] + rest[v + 2] * rest[v + 2], 1.0F, 1e-4F);
    EXPECT_GT(rest[v + 2], 0.2F);  // the patch looks along +Z
  }
  fascia_face_values(face.face)[0] = 1.0F;
  ASSERT_EQ(fascia_face_pose(face.face), FASCIA_OK);
  EXPECT_GT(largest_motion(rest, face.normals()), 1e-3);
  fascia_face_clear(face.face);
  ASSERT_EQ(fascia_face_pose(face.face), FASCIA_OK);
  EXPECT_LT(largest_motion(rest, face.normals()), 1e-3);
}

TEST(FaceTest, TheJawTurnsDown) {
  const Loaded rig;
  const Face face(rig.asset);
  float matrix[16] = {};
  ASSERT_EQ(fascia_face_jaw(face.face, matrix), FASCIA_OK);
  EXPECT_EQ(matrix[0], 1.0F);
  EXPECT_EQ(matrix[13], 0.0F);
  const std::vector<float> rest = face.positions();
  ASSERT_EQ(fascia_face_set(face.face, "jaw_open", 1.0F), FASCIA_OK);
  ASSERT_EQ(fascia_face_pose(face.face), FASCIA_OK);
  ASSERT_EQ(fascia_face_jaw(face.face, matrix), FASCIA_OK);
  // The chin point (0, 1.53, 0.07) goes down.
  EXPECT_LT(matrix[5] * 1.53F + matrix[9] * 0.07F + matrix[13], 1.52F);
}

TEST(FaceTest, WritesIntoTheHostsMemory) {
  const Loaded rig;
  const Face face(rig.asset);
  const std::vector<float> positions = face.positions();
  struct Vertex {
    float colour[4];
    float position[3];
  };
  std::vector<Vertex> vertices(side * side);
  ASSERT_EQ(fascia_face_write_positions(face.face, 0, vertices[0].position, sizeof(Vertex), vertices.size()),
            FASCIA_OK);
  EXPECT_EQ(vertices[5].position[1], positions[16]);
  EXPECT_EQ(vertices[5].colour[0], 0.0F);
  EXPECT_EQ(fascia_face_write_positions(face.face, 0, vertices.data(), sizeof(Vertex), 5),
            FASCIA_ERROR_ARGUMENT);
  EXPECT_EQ(fascia_face_write_positions(face.face, 1, vertices.data(), sizeof(Vertex), 500),
            FASCIA_ERROR_ARGUMENT);
}

TEST(FaceTest, TheAssetMayGoFirst) {
  auto rig = std::make_unique<Loaded>();
  const Face face(rig->asset);
  rig.reset();
  fascia_face_values(face.face)[0] = 0.5F;
  EXPECT_EQ(fascia_face_pose(face.face), FASCIA_OK);
}

TEST(FaceTest, APointerOnceTakenKeepsUpWithTheFace) {
  const Loaded rig;
  const Face face(rig.asset);
  fascia_vectors taken{};
  taken.struct_size = sizeof taken;
  ASSERT_EQ(fascia_face_positions(face.face, 0, &taken), FASCIA_OK);
  const std::vector<float> before(taken.data, taken.data + 3 * taken.count);
  fascia_face_values(face.face)[0] = 0.8F;
  fascia_face_pose(face.face);
  EXPECT_NE(std::vector<float>(taken.data, taken.data + 3 * taken.count), before);
  EXPECT_EQ(std::vector<float>(taken.data, taken.data + 3 * taken.count), face.positions());
}

TEST(FaceTest, UnknownChoicesAreRefused) {
  const Loaded rig;
  fascia_face* face = nullptr;
  fascia_face_options options = fascia_default_face_options();
  options.level = 4;
  EXPECT_EQ(fascia_face_create(rig.asset, &options, &face), FASCIA_ERROR_ARGUMENT);
  options.level = 0;
  options.space = static_cast<fascia_space>(9);
  EXPECT_EQ(fascia_face_create(rig.asset, &options, &face), FASCIA_ERROR_ARGUMENT);
  EXPECT_EQ(face, nullptr);
}

TEST(CurvesTest, DriveAFaceAndAddUp) {
  const Loaded rig;
  const Face face(rig.asset);
  const std::string csv = "time,zygomaticus_major_left,jawOpen,HeadYaw\n0,0,0,0\n1,0.8,1,0.2\n";
  fascia_curves* curves = nullptr;
  ASSERT_EQ(fascia_curves_load(csv.data(), csv.size(), &curves), FASCIA_OK) << fascia_last_message();
  fascia_curves_info info = {};
  info.struct_size = sizeof info;
  ASSERT_EQ(fascia_curves_get_info(curves, &info), FASCIA_OK);
  EXPECT_EQ(info.count, 3U);
  EXPECT_EQ(info.duration, 1.0);
  uint32_t count = 0;
  uint8_t matched[3] = {};
  ASSERT_EQ(fascia_curves_match(curves, rig.asset, &count, matched), FASCIA_OK);
  EXPECT_EQ(count, 2U);
  EXPECT_EQ(matched[2], 0);
  ASSERT_EQ(fascia_curves_apply(curves, 0.5, 1.0F, face.face), FASCIA_OK);
  ASSERT_EQ(fascia_curves_apply(curves, 1.0, 0.25F, face.face), FASCIA_OK);
  ASSERT_EQ(fascia_face_step(face.face, 0.01F), FASCIA_OK);
  const float* effective = fascia_face_effective_values(face.face);
  EXPECT_NEAR(effective[0], 0.4F + 0.25F * 0.8F, 1e-6F);
  EXPECT_NEAR(effective[2], 0.5F + 0.25F, 1e-6F);
  // Used up by the step.
  ASSERT_EQ(fascia_face_step(face.face, 0.01F), FASCIA_OK);
  EXPECT_EQ(effective[0], 0.0F);
  fascia_curves_release(curves);
}

TEST(CurvesTest, TheRigsOwnAnimationPlays) {
  const std::vector<uint8_t> bytes = fascia::test::tiny_rig_file();
  const Loaded rig(bytes);
  fascia_curves* curves = nullptr;
  ASSERT_EQ(fascia_curves_load(bytes.data(), bytes.size(), &curves), FASCIA_OK) << fascia_last_message();
  const Face face(rig.asset);
  ASSERT_EQ(fascia_curves_apply(curves, 0.5, 1.0F, face.face), FASCIA_OK);
  ASSERT_EQ(fascia_face_pose(face.face), FASCIA_OK);
  EXPECT_NEAR(fascia_face_effective_values(face.face)[0], 0.4F, 1e-6F);
  fascia_curves_release(curves);
}

}  // namespace
