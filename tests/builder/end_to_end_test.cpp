// The embedded head from file to pose, and the numbers of its poses as a snapshot.
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

#include "cli/demo_curves.h"
#include "formats/scene.h"
#include "tests/builder/face_checks.h"

namespace fascia::testing {
namespace {

namespace fs = std::filesystem;

class EmbeddedHead : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    folder_ = new fs::path(fs::temp_directory_path() / "fascia_end_to_end");
    fs::create_directories(*folder_);
    cli::write_embedded_head(*folder_ / "head.obj", *folder_ / "landmarks.json");
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

TEST_F(EmbeddedHead, MovesAsAnatomySays) { expect_face_moves_as_anatomy_says(*face_); }

TEST_F(EmbeddedHead, HasSoundMuscles) { expect_muscles_are_sound(face_->report()); }

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

/// Poses and landmarks whose motion the snapshot keeps; millimetres.
const std::vector<std::pair<std::string, PosedFace::Values>>& snapshot_poses() {
  static const std::vector<std::pair<std::string, PosedFace::Values>> poses = {
      {"smile", {{"arkit:mouthSmileLeft", 1}, {"arkit:mouthSmileRight", 1}}},
      {"frown", {{"arkit:mouthFrownLeft", 1}, {"arkit:mouthFrownRight", 1}, {"arkit:browDownLeft", 1}, {"arkit:browDownRight", 1}}},
      {"surprise", {{"arkit:browInnerUp", 1}, {"arkit:browOuterUpLeft", 1}, {"arkit:browOuterUpRight", 1}, {"arkit:jawOpen", 0.6}}},
      {"blink", {{"arkit:eyeBlinkLeft", 1}, {"arkit:eyeBlinkRight", 1}}},
      {"pucker", {{"arkit:mouthPucker", 1}}},
      {"jaw_open", {{"jaw_open", 1}}},
      {"left_sneer", {{"arkit:noseSneerLeft", 1}}}};
  return poses;
}

constexpr const char* snapshot_landmarks[] = {
    "cheilion_left", "cheilion_right", "labiale_superius", "labiale_inferius", "pogonion", "superciliare_left", "superciliare_mediale_right",
    "palpebrale_superius_left", "palpebrale_inferius_left", "alare_left", "subnasale", "malare_left", "buccale_right", "glabella", "menton"};

TEST_F(EmbeddedHead, PosesAsInTheSnapshot) {
  const double tolerance_mm = 0.1;
  const fs::path path = fs::path(FASCIA_SNAPSHOTS) / "embedded_head_poses.json";
  nlohmann::ordered_json now;
  for (const auto& [name, values] : snapshot_poses()) {
    face_->pose(values);
    for (const char* landmark : snapshot_landmarks) {
      const Vec3 moved = face_->moved(landmark);
      // Microns are noise between compilers.
      const auto rounded = [](double x) { return std::round(1e3 * x) / 1e3; };
      now[name][landmark] = {rounded(moved[0]), rounded(moved[1]), rounded(moved[2])};
    }
  }
  if (std::getenv("FASCIA_RENEW_SNAPSHOTS")) {
    formats::write_text(path, now.dump(1) + "\n");
    GTEST_SKIP() << "snapshot renewed: look at the poses with 'fascia render' before committing it";
  }
  ASSERT_TRUE(fs::exists(path)) << "renew it with FASCIA_RENEW_SNAPSHOTS=1";
  std::ifstream file(path);
  const nlohmann::json wanted = nlohmann::json::parse(file);
  for (const auto& [name, values] : snapshot_poses())
    for (const char* landmark : snapshot_landmarks)
      for (int k = 0; k < 3; ++k)
        EXPECT_NEAR(now[name][landmark][k].get<double>(), wanted[name][landmark][k].get<double>(), tolerance_mm)
            << name << " " << landmark << " axis " << k;
}

}  // namespace
}  // namespace fascia::testing
