// Landmarks by the command line.
#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "tests/fit/live.h"

namespace fascia::fit {
namespace {

/// The tool takes detectors' mark-ups, and says so of others.
TEST_F(Live, ToolFitsPointsOfDetectors) {
  const std::vector<Vec3> standing = places_of(values_of({{"jaw_open", 0.35F}}), false);
  const Mat4 to_file = subject->file().rig.input_to_metres.cast<double>().inverse();
  for (const LandmarkSet& set : landmark_sets()) {
    nlohmann::json list(set.points, nullptr);
    for (const LandmarkSet::Entry& entry : set.entries)
      for (size_t l = 0; l < landmarks.size(); ++l)
        if (landmarks[l].entry.landmark == entry.landmark)
          for (const uint32_t p : entry.points) {
            const Vec3 place = transform_point(to_file, standing[l]);
            list[p] = {place.x(), place.y(), place.z()};
          }
    std::ofstream(at(set.name + ".json")) << nlohmann::json{{"points", list}};
    const cli::Outcome fitted = run("fit " + at("rig.glb") + " --target " + at(set.name + ".json") + " -o " +
                                    at("a.json") + " --json");
    ASSERT_EQ(fitted.code, 0) << fitted.err;
    const nlohmann::json report = nlohmann::json::parse(fitted.out);
    EXPECT_NEAR(report["activations"].value("jaw_open", 0.0), 0.35, 0.05) << set.name;
    EXPECT_LT(report["rms_mm"].get<double>(), 0.3) << set.name;
  }
  std::ofstream(at("few.json")) << R"({"points": [[0,0,0],[1,0,0]]})";
  const cli::Outcome refused =
      run("fit " + at("rig.glb") + " --target " + at("few.json") + " -o " + at("a.json"));
  EXPECT_EQ(refused.code, 1);
  EXPECT_NE(refused.err.find("478"), std::string::npos) << refused.err;
}

/// Landmarks in the pictures of a camera, one face and a take; the file says nothing of where the head is.
TEST_F(Live, ToolFitsPictures) {
  const Mat3 turn = before_camera(0.3);
  const auto pictured = [&](const std::vector<Vec3>& places) {
    nlohmann::json list(points, nullptr);
    for (size_t l = 0; l < landmarks.size(); ++l)
      for (const uint32_t p : landmarks[l].entry.points) {
        const Vec3 at = pixel(turn, places[l]);
        list[p] = {at.x(), at.y()};
      }
    return list;
  };
  const std::map<std::string, float> smile = {{"jaw_open", 0.3F},
                                              {"zygomaticus_major_superior_left", 0.6F},
                                              {"zygomaticus_major_superior_right", 0.6F}};
  const nlohmann::json posed = pictured(places_of(values_of(smile), false));
  std::ofstream(at("picture.json")) << nlohmann::json{{"points", posed}};
  const std::string rig = "fit " + at("rig.glb"), camera = " --camera 1400,640,360";
  const cli::Outcome one = run(rig + " --target " + at("picture.json") + camera + " -o " + at("a.json") +
                               " --report " + at("pictures") + " --json");
  ASSERT_EQ(one.code, 0) << one.err;
  const nlohmann::json report = nlohmann::json::parse(one.out);
  EXPECT_NEAR(report["activations"].value("jaw_open", 0.0), 0.3, 0.08) << report;
  EXPECT_LT(report["rms_mm"].get<double>(), 0.4);
  EXPECT_GT(report["share"].get<double>(), 0.97);
  EXPECT_TRUE(std::filesystem::exists(at("pictures/residual.png")));

  nlohmann::json frames;
  for (int frame = 0; frame < 12; ++frame) {
    const auto share = static_cast<float>(frame) / 11.0F;
    std::map<std::string, float> values = smile;
    for (auto& [name, value] : values)
      value *= share;
    frames.push_back({{"time", frame / 30.0}, {"points", pictured(places_of(values_of(values), frame > 0))}});
  }
  std::ofstream(at("pictures.json")) << nlohmann::json{{"frames", frames}};
  const cli::Outcome take =
      run(rig + " --target " + at("pictures.json") + camera + " -o " + at("take.csv") + " --json");
  ASSERT_EQ(take.code, 0) << take.err;
  const nlohmann::json played = nlohmann::json::parse(take.out);
  EXPECT_GT(played["share"].get<double>(), 0.95);
  EXPECT_TRUE(played["converged"].get<bool>());
  for (const nlohmann::json& frame : played["targets"])
    EXPECT_TRUE(frame["converged"].get<bool>()) << frame["name"];
  EXPECT_EQ(run("play " + at("rig.glb") + " --curves " + at("take.csv") + " -o " + at("take.glb")).code, 0);

  const auto expect_error = [&](const std::string& arguments, const std::string& says) {
    const cli::Outcome outcome = run(rig + " " + arguments + " -o " + at("x.json"));
    EXPECT_EQ(outcome.code, 1) << arguments << outcome.err;
    EXPECT_NE(outcome.err.find(says), std::string::npos) << arguments << outcome.err;
  };
  expect_error("--target " + at("picture.json"), "--camera");
  expect_error("--target " + at("picture.json") + " --camera 1400", "FOCAL,X,Y");
  expect_error("--target " + at("head.obj") + camera, "pictures");
  std::ofstream(at("mixed.json")) << R"({"landmarks": {"nasion": [1, 2], "menton": [1, 2, 3]}})";
  expect_error("--target " + at("mixed.json") + camera, "another count");
}

}  // namespace
}  // namespace fascia::fit
