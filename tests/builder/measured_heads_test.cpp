// Heads of real people and of another maker, when the measured data are there.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/builder/face_checks.h"
#include "tests/paths/paths.h"

namespace fascia::testing {
namespace {

namespace fs = std::filesystem;

const fs::path data = test::measured_data() / "data";
const fs::path fixtures = test::data();

/// Lengths of the fibres of a published finite-element face (ArtiSynth), and our part each stands for. Its
/// medial depressor labii inferioris ends half way up the lip and is not held to it.
void expect_published_lengths(const rigging::BuildReport& report, const fs::path& published) {
  struct Pair {
    const char* muscle;
    int fibre;
    const char* ours;
  };
  const Pair pairs[] = {{"DAO", 1, "depressor_anguli_oris"},
                        {"BUC", 1, "buccinator_upper"},
                        {"BUC", 2, "buccinator_lower"},
                        {"MENT", 1, "mentalis"},
                        {"OOM", 1, "orbicularis_oris_marginal_upper"},
                        {"OOM", 2, "orbicularis_oris_marginal_lower"},
                        {"OOP", 1, "orbicularis_oris_peripheral_upper"},
                        {"OOP", 2, "orbicularis_oris_peripheral_lower"},
                        {"DLI", 2, "depressor_labii_inferioris_lateral"},
                        {"LLSAN", 1, "levator_labii_superioris_alaeque_nasi_labial"},
                        {"LLSAN", 2, "levator_labii_superioris_alaeque_nasi_alar"},
                        {"LAO", 1, "levator_anguli_oris"},
                        {"RIS", 1, "risorius"},
                        {"ZYG", 1, "zygomaticus_major_superior"},
                        {"LLS", 1, "levator_labii_superioris_medial"}};
  std::ifstream file(published);
  const nlohmann::json fibres = nlohmann::json::parse(file);
  std::vector<double> ratios;
  for (const Pair& pair : pairs) {
    double wanted = 0.0, length = 0.0;
    for (const auto& fibre : fibres)
      if (fibre["muscle"] == pair.muscle && fibre["fibre"] == pair.fibre) wanted = fibre["length_mm"];
    for (const auto& muscle : report.muscles)
      if (muscle.name == std::string(pair.ours) + "_left") length = muscle.length_mm;
    ASSERT_GT(wanted, 0.0) << pair.muscle;
    ratios.push_back(length / wanted);
  }
  std::vector<double> sorted = ratios;
  std::sort(sorted.begin(), sorted.end());
  const double size = sorted[sorted.size() / 2];  // of one face to the other
  for (size_t k = 0; k < ratios.size(); ++k)
    EXPECT_NEAR(ratios[k] / size, 1.0, 0.25) << pairs[k].ours;
}

TEST(MeasuredHeads, IctMeanHeadMovesAnatomically) {
  const fs::path head = data / "ict/neutral.glb";
  if (!fs::exists(head)) GTEST_SKIP() << "the measured heads are not at " << data;
  PosedFace face(head, fixtures / "ict_neutral_landmarks.json", "test_ict");
  expect_face_moves_as_anatomy_says(face);
  expect_muscles_are_sound(face.report());
  expect_published_lengths(face.report(), data / "artisynth/face_fibres_left_mm.json");
}

TEST(MeasuredHeads, MakeHumanBodyBuilds) {
  const fs::path body = data / "heads/makehuman_body.obj";
  if (!fs::exists(body)) GTEST_SKIP() << "the measured heads are not at " << data;
  PosedFace face(body, fixtures / "makehuman_landmarks.json", "test_makehuman");
  EXPECT_EQ(face.report().bone_outside_skin, 0);
  EXPECT_EQ(face.report().units, "dm");
  expect_muscles_are_sound(face.report());
  face.pose({});
  EXPECT_EQ(face.largest_motion(), 0.0);
  face.pose({{"jaw_open", 1}});
  EXPECT_GE(face.moved("labiale_superius")[1] - face.moved("labiale_inferius")[1], 20.0);
}

}  // namespace
}  // namespace fascia::testing
