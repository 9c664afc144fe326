// A rig of every version of the format that was released is read by every later library
// (docs/integration.md).
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "rig/model/extensions.h"
#include "tests/paths/paths.h"
#include "tests/runtime/loaded.h"

namespace {

using namespace fascia::test;

TEST(Released, RigsAreReadAndMove) {
  int rigs = 0;
  for (const auto& entry : std::filesystem::directory_iterator(data() / "released")) {
    std::ifstream stream(entry.path(), std::ios::binary);
    const std::vector<uint8_t> bytes{std::istreambuf_iterator<char>(stream), {}};
    const Loaded rig(bytes);
    ASSERT_NE(rig.asset, nullptr) << entry.path();
    const Face face(rig.asset);
    const std::vector<float> rest = face.positions();
    ASSERT_EQ(fascia_face_set(face.face, "arkit:mouthSmileLeft", 1.0F), FASCIA_OK) << fascia_last_message();
    ASSERT_EQ(fascia_face_pose(face.face), FASCIA_OK);
    // Where the smile brings the corner: millimetres, as when the rig was released.
    const std::vector<float> posed = face.positions();
    EXPECT_GT(left_corner(posed, 1) - left_corner(rest, 1), 1e-4F) << entry.path();
    EXPECT_LT(largest_motion(rest, posed), 0.02) << entry.path();
    ++rigs;
  }
  EXPECT_GE(rigs, 1);
}

TEST(Released, ARigOfThePresentVersionIsKept) {
  EXPECT_TRUE(std::filesystem::exists(data() / "released" / ("rig-" + fascia::rig::spec_version + ".glb")))
      << "a new version of the format: keep a rig of it (tests/data/released)";
}

}  // namespace
