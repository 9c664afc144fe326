// Heads of real people and of another maker, when the measured data are there.
#include <gtest/gtest.h>

#include "tests/builder/face_checks.h"

namespace fascia::testing {
namespace {

namespace fs = std::filesystem;

const fs::path data = fs::path(FASCIA_MEASURED_DATA) / "data";
const fs::path fixtures = FASCIA_TEST_DATA;

TEST(MeasuredHeads, IctMeanHeadMovesAsAnatomySays) {
  const fs::path head = data / "ict/neutral.glb";
  if (!fs::exists(head)) GTEST_SKIP() << "the measured heads are not at " << data;
  PosedFace face(head, fixtures / "ict_neutral_landmarks.json", "test_ict");
  expect_face_moves_as_anatomy_says(face);
}

TEST(MeasuredHeads, MakeHumanBodyBuilds) {
  const fs::path body = data / "heads/makehuman_body.obj";
  if (!fs::exists(body)) GTEST_SKIP() << "the measured heads are not at " << data;
  PosedFace face(body, fixtures / "makehuman_landmarks.json", "test_makehuman");
  EXPECT_EQ(face.report().bone_outside_skin, 0);
  EXPECT_EQ(face.report().units, "dm");
  face.pose({});
  EXPECT_EQ(face.largest_motion(), 0.0);
  face.pose({{"jaw_open", 1}});
  EXPECT_GE(face.moved("labiale_superius")[1] - face.moved("labiale_inferius")[1], 20.0);
}

}  // namespace
}  // namespace fascia::testing
