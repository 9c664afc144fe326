// The embedded head from file to pose; tests/snapshots keeps the numbers of its poses.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "builder/rigging/embedded_head.h"
#include "formats/scene.h"
#include "tests/builder/face_checks.h"
#include "tests/paths/paths.h"

namespace fascia::testing {
namespace {

namespace fs = std::filesystem;

class EmbeddedHead : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new fs::path(fs::temp_directory_path() / "fascia_end_to_end");
    fs::create_directories(*folder_);
    rigging::write_embedded_head(*folder_ / "head.obj", *folder_ / "landmarks.json");
    face_ = new PosedFace(*folder_ / "head.obj", *folder_ / "landmarks.json", "test_embedded");
  }
  static void TearDownTestSuite() {
    delete face_;
    fs::remove_all(*folder_);
    delete folder_;
  }
  static fs::path* folder_;
  static PosedFace* face_;
};

fs::path* EmbeddedHead::folder_ = nullptr;
PosedFace* EmbeddedHead::face_ = nullptr;

TEST_F(EmbeddedHead, MovesAnatomically) {
  expect_face_moves_as_anatomy_says(*face_);
}

TEST_F(EmbeddedHead, HasSoundMuscles) {
  expect_muscles_are_sound(face_->report());
}

TEST_F(EmbeddedHead, MirrorsItself) {
  const auto mirrored = [](Vec3 v) { return Vec3(-v[0], v[1], v[2]); };
  for (const char* muscle : {"zygomaticus_major", "frontalis", "depressor_anguli_oris"}) {
    face_->pose({{std::string(muscle) + "_left", 1}});
    const Vec3 left = face_->moved("cheilion_left"), brow = face_->moved("superciliare_left");
    face_->pose({{std::string(muscle) + "_right", 1}});
    EXPECT_LT((face_->moved("cheilion_right") - mirrored(left)).norm(), 1.0) << muscle;
    EXPECT_LT((face_->moved("superciliare_right") - mirrored(brow)).norm(), 1.0) << muscle;
  }
}

TEST_F(EmbeddedHead, BuildsTheSameBytesAgain) {
  const PosedFace again(*folder_ / "head.obj", *folder_ / "landmarks.json", "test_embedded_again");
  EXPECT_EQ(formats::read_bytes(again.rig_path()), formats::read_bytes(face_->rig_path()));
}

/// Distances between the vertices of two faces of one rig, ascending, millimetres.
std::vector<double> gaps(cli::Face& a, cli::Face& b) {
  std::vector<double> list;
  for (size_t m = 0; m < a.meshes().size(); ++m) {
    const auto p = a.positions(m), q = b.positions(m);
    for (size_t i = 0; i + 2 < p.size(); i += 3)
      list.push_back(1e3 *
                     static_cast<double>(std::hypot(p[i] - q[i], p[i + 1] - q[i + 1], p[i + 2] - q[i + 2])));
  }
  std::sort(list.begin(), list.end());
  return list;
}
double mean(const std::vector<double>& list) {
  return std::accumulate(list.begin(), list.end(), 0.0) / static_cast<double>(list.size());
}

/// Poses whose motion is compared between solvers.
const std::vector<std::pair<std::string, PosedFace::Values>>& compared_poses() {
  static const std::vector<std::pair<std::string, PosedFace::Values>> poses = {
      {"smile", {{"arkit:mouthSmileLeft", 1}, {"arkit:mouthSmileRight", 1}}},
      {"frown",
       {{"arkit:mouthFrownLeft", 1},
        {"arkit:mouthFrownRight", 1},
        {"arkit:browDownLeft", 1},
        {"arkit:browDownRight", 1}}},
      {"surprise",
       {{"arkit:browInnerUp", 1},
        {"arkit:browOuterUpLeft", 1},
        {"arkit:browOuterUpRight", 1},
        {"arkit:jawOpen", 0.6}}},
      {"blink", {{"arkit:eyeBlinkLeft", 1}, {"arkit:eyeBlinkRight", 1}}},
      {"pucker", {{"arkit:mouthPucker", 1}}},
      {"jaw_open", {{"jaw_open", 1}}},
      {"left_sneer", {{"arkit:noseSneerLeft", 1}}}};
  return poses;
}

TEST_F(EmbeddedHead, TheFastSolverPosesAndMovesAsTheReference) {
  cli::Face own(face_->rig_path(), {FASCIA_SPACE_METRES, "own", "low"}),
      reference(face_->rig_path(), {FASCIA_SPACE_METRES, "reference", "low"});
  for (const auto& [name, values] : compared_poses()) {
    for (cli::Face* face : {&own, &reference}) {
      face->clear();
      face->reset();
      for (const auto& [channel, value] : values)
        face->set(channel, value);
      face->pose();
    }
    const std::vector<double> list = gaps(own, reference);
    // A jaw opened wide has two minima, which differ at the corners of the mouth, and so has a lower lid
    // pressed together by a blink: a few nodes in a hundred.
    const bool opens_wide = name == "jaw_open" || name == "surprise";
    const double usual = opens_wide ? 0.95 : 0.99, most = opens_wide || name == "blink" ? 0.25 : 0.05;
    EXPECT_LT(mean(list), opens_wide ? 0.05 : 0.02) << name;
    EXPECT_LT(list[static_cast<size_t>(usual * static_cast<double>(list.size()))], most) << name;
  }
  for (cli::Face* face : {&own, &reference}) {
    face->clear();
    face->reset();
  }
  constexpr int frames = 30;
  double sum = 0.0, worst = 0.0;
  for (int frame = 0; frame < frames; ++frame) {
    for (cli::Face* face : {&own, &reference}) {
      face->set("arkit:mouthSmileLeft", 0.5 - 0.5 * std::cos(0.2 * frame));
      face->set("arkit:jawOpen", 0.2 - 0.2 * std::cos(0.15 * frame));
      face->set("arkit:browInnerUp", 0.5 - 0.5 * std::cos(0.1 * frame));
      face->step(1.0 / 60.0);
    }
    const double gap = mean(gaps(own, reference));
    sum += gap;
    worst = std::max(worst, gap);
  }
  // Two iterations a substep against steps solved to the end: lips that meet go their way a little later.
  EXPECT_LT(sum / frames, 0.03);
  EXPECT_LT(worst, 0.1);
}

}  // namespace
}  // namespace fascia::testing
