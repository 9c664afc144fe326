// Activations found again from what they make, on the embedded head at low detail.
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <random>

#include "fit/fit.h"
#include "formats/scene.h"
#include "geometry/error.h"
#include "tests/fit/embedded_subject.h"

namespace fascia::fit {
namespace {

namespace fs = std::filesystem;
using nlohmann::json;

class Fit : public EmbeddedSubject {
 protected:
  static std::vector<float> rest() { return values_of({}); }
  static void set(std::vector<float>& values, const std::string& name, float value) {
    const int32_t channel = subject->channel(name);
    ASSERT_GE(channel, 0) << name;
    values[static_cast<size_t>(channel)] = value;
  }
  static Target target_of(const std::vector<float>& values) {
    subject->pose(values, false);
    return {subject->displacements(values), std::vector<double>(subject->vertex_count(), 1.0)};
  }
};

/// Columns and adjoint against differences of the pose itself.
TEST_F(Fit, DerivativesAreThoseOfThePose) {
  std::vector<float> values = rest();
  set(values, "zygomaticus_major_superior_left", 0.5F);
  set(values, "frontalis_medial_right", 0.4F);
  set(values, "depressor_anguli_oris_left", 0.3F);
  set(values, "jaw_open", 0.2F);
  sim::Sensitivity sensitivity(subject->model());
  subject->pose(values, false);
  ASSERT_TRUE(sensitivity.linearise(subject->controls(values), subject->nodes()));
  const size_t nodes = subject->nodes().size();
  Eigen::VectorXd slope(static_cast<Eigen::Index>(3 * nodes));
  for (Eigen::Index i = 0; i < slope.size(); ++i)
    slope[i] = i % 3 == 0 ? 0.2 : i % 3 == 1 ? 1.0 : 0.5;
  const std::vector<uint32_t> channels = {
      static_cast<uint32_t>(subject->channel("zygomaticus_major_superior_left")),
      static_cast<uint32_t>(subject->channel("frontalis_medial_right")),
      static_cast<uint32_t>(subject->channel("depressor_anguli_oris_left"))};
  const Eigen::VectorXd exact = sensitivity.adjoint(slope, channels);
  const Eigen::MatrixXd columns = sensitivity.columns(channels), jaw = sensitivity.jaw_columns();
  const auto loss = [&](const std::vector<float>& moved) {
    subject->pose(moved, true);
    double sum = 0.0;
    for (size_t n = 0; n < nodes; ++n)
      sum += slope.segment<3>(static_cast<Eigen::Index>(3 * n)).dot(subject->nodes()[n]);
    return sum;
  };
  for (size_t k = 0; k < 4; ++k) {
    const size_t channel = k < 3 ? channels[k] : static_cast<size_t>(subject->channel("jaw_open"));
    std::vector<float> low = values, high = values;
    low[channel] = std::max(0.0F, values[channel] - 0.03F);
    high[channel] = values[channel] + 0.03F;
    const double expected = (loss(high) - loss(low)) / static_cast<double>(high[channel] - low[channel]);
    const auto index = static_cast<Eigen::Index>(k);
    EXPECT_NEAR(exact[index], expected, 0.05 * std::abs(expected) + 5e-3) << k;
    const double standin = slope.dot(k < 3 ? columns.col(index) : jaw.col(0));
    EXPECT_NEAR(standin, expected, 0.3 * std::abs(expected) + 2e-2) << k;
  }
}

TEST_F(Fit, FindsRandomActivationsAgain) {
  std::mt19937 random(7);
  std::vector<uint32_t> muscles;
  const sim::Sensitivity sensitivity(subject->model());
  for (uint32_t c = 0; c < subject->channels().size(); ++c)
    if (subject->channels()[c].group == "muscle" && sensitivity.listens(c)) muscles.push_back(c);
  ASSERT_GT(muscles.size(), 40U);
  Fitter fitter(*subject);
  for (int pose = 0; pose < 12; ++pose) {
    std::vector<float> values = rest();
    for (int k = 0; k < 5; ++k)
      values[muscles[random() % muscles.size()]] =
          0.3F + 0.6F * static_cast<float>(random() % 1000) / 1000.0F;
    const FitResult result = fitter.fit(target_of(values));
    EXPECT_LT(result.rms_mm, 0.05) << pose;
    EXPECT_GT(result.share, 0.99) << pose;
    double square = 0.0;
    for (size_t c = 0; c < values.size(); ++c) {
      square += std::pow(static_cast<double>(result.activations[c] - values[c]), 2);
      EXPECT_GE(result.activations[c], subject->channels()[c].minimum);
      EXPECT_LE(result.activations[c], subject->channels()[c].maximum);
      EXPECT_NEAR(result.activations[c], values[c], 0.03) << pose << " " << subject->channels()[c].name;
    }
    EXPECT_LT(std::sqrt(square / static_cast<double>(muscles.size())), 0.01) << pose;
    EXPECT_TRUE(result.converged) << pose;
  }
}

/// Half a millimetre of a scanner's noise at every vertex.
TEST_F(Fit, NoiseIsNotFollowed) {
  std::vector<float> values = rest();
  set(values, "zygomaticus_major_superior_left", 0.7F);
  set(values, "frontalis_medial_right", 0.5F);
  set(values, "jaw_open", 0.3F);
  Target target = target_of(values);
  const Eigen::VectorXd truth = target.displacements;
  std::mt19937 random(5);
  std::normal_distribution<double> off(0.0, 5e-4 / std::sqrt(3.0));
  for (Eigen::Index i = 0; i < truth.size(); ++i)
    target.displacements[i] += off(random);
  const FitResult result = Fitter(*subject).fit(target);
  const double rms = std::sqrt(3.0 * (result.displacements - truth).squaredNorm() / truth.size());
  EXPECT_LT(1e3 * rms, 0.06);
  EXPECT_NEAR(result.rms_mm, 0.5, 0.03) << "what is left is the noise";
}

TEST_F(Fit, RestPoseGivesZeroActivations) {
  const FitResult result = Fitter(*subject).fit(target_of(rest()));
  EXPECT_EQ(result.activations, rest());
  EXPECT_LT(result.rms_mm, 1e-6);
}

TEST_F(Fit, JawAndEyesAreFound) {
  std::vector<float> values = rest();
  set(values, "jaw_open", 0.45F);
  set(values, "eye_yaw_left", 0.3F);
  set(values, "eye_pitch_left", -0.2F);
  const FitResult result = Fitter(*subject).fit(target_of(values));
  EXPECT_LT(result.rms_mm, 0.05);
  for (const char* name : {"jaw_open", "eye_yaw_left", "eye_pitch_left"}) {
    const auto channel = static_cast<size_t>(subject->channel(name));
    EXPECT_NEAR(result.activations[channel], values[channel], 0.02) << name;
  }
}

/// A scan without eyeballs: lids follow the gaze, and tell it.
TEST_F(Fit, TheGazeOfHiddenEyesIsEstimatedFromTheLids) {
  for (const char* name : {"eye_yaw_left", "eye_pitch_left"}) {
    std::vector<float> values = rest();
    set(values, name, 0.4F);
    Target target = target_of(values);
    for (size_t v = 0; v < target.confidence.size(); ++v)
      if (subject->eyes()[v] != 0) target.confidence[v] = 0.0;
    Fitter fitter(*subject);
    const FitResult result = fitter.fit(target);
    EXPECT_NEAR(result.activations[static_cast<size_t>(subject->channel(name))], 0.4F, 0.1F) << name;
    EXPECT_GT(result.share, 0.9) << name;
    EXPECT_NEAR(result.activations[static_cast<size_t>(subject->channel("eye_yaw_right"))], 0.0F, 0.02F)
        << name;
    // Where the eyeballs are seen at rest, they count: the lids do not turn them.
    for (size_t v = 0; v < target.confidence.size(); ++v)
      if (subject->eyes()[v] != 0) {
        target.confidence[v] = 1.0;
        target.displacements.segment<3>(static_cast<Eigen::Index>(3 * v)).setZero();
      }
    EXPECT_EQ(fitter.fit(target).activations[static_cast<size_t>(subject->channel(name))], 0.0F) << name;
  }
}

TEST_F(Fit, VerticesWithoutConfidenceAreIgnored) {
  std::vector<float> values = rest();
  set(values, "zygomaticus_minor_left", 0.6F);
  Target target = target_of(values);
  for (size_t v = 0; v < target.confidence.size(); v += 3) {
    target.displacements.segment<3>(static_cast<Eigen::Index>(3 * v)).setConstant(1.0);
    target.confidence[v] = 0.0;
  }
  EXPECT_LT(Fitter(*subject).fit(target).rms_mm, 0.05);
  std::fill(target.confidence.begin(), target.confidence.end(), 0.0);
  EXPECT_THROW(Fitter(*subject).fit(target), Error);
}

/// A take whose mouth goes out of sight: what moved it stays, whatever the rest of the face does.
TEST_F(Fit, WhatIsNoLongerSeenStays) {
  std::vector<float> values = rest();
  Fitter fitter(*subject);
  const auto jaw = static_cast<size_t>(subject->channel("jaw_open")),
             brow = static_cast<size_t>(subject->channel("frontalis_medial_left")),
             smile = static_cast<size_t>(subject->channel("zygomaticus_major_superior_left"));
  const double brow_height =
      0.5 * (subject->file().rig.skull.eye_left.centre.y() + subject->file().rig.skull.eye_right.centre.y());
  FitResult seen, result;
  for (int frame = 0; frame < 12; ++frame) {
    set(values, "jaw_open", std::min(0.4F, 0.1F * static_cast<float>(frame + 1)));
    set(values, "zygomaticus_major_superior_left", std::min(0.6F, 0.15F * static_cast<float>(frame + 1)));
    set(values, "frontalis_medial_left", 0.05F * static_cast<float>(frame));
    Target target = target_of(values);
    for (size_t v = 0; frame >= 5 && v < target.confidence.size(); ++v)
      if (subject->rest()[static_cast<Eigen::Index>(3 * v + 1)] < brow_height) target.confidence[v] = 0.0;
    result = fitter.follow(target);
    if (frame == 4) seen = result;
  }
  EXPECT_NEAR(seen.activations[jaw], 0.4F, 0.02F);
  EXPECT_NEAR(result.activations[jaw], seen.activations[jaw], 0.02F);
  EXPECT_NEAR(result.activations[smile], seen.activations[smile], 0.03F);
  EXPECT_NEAR(result.activations[brow], values[brow], 0.05F) << "what is seen goes on";
}

TEST_F(Fit, ToolFitsAPoseOfTheRig) {
  for (const char* kind : {"posed.obj", "posed.glb"}) {
    ASSERT_EQ(
        run("pose " + at("rig.glb") + " --set zygomaticus_minor_left=0.7 --set jaw_open=0.3 -o " + at(kind))
            .code,
        0);
    const cli::Outcome fitted = run("fit " + at("rig.glb") + " --target " + at(kind) + " -o " + at("a.json") +
                                    " --report " + at("report") + " --json");
    ASSERT_EQ(fitted.code, 0) << fitted.err;
    const json report = json::parse(fitted.out);
    EXPECT_GT(report["share"].get<double>(), 0.99) << kind;
    EXPECT_LT(report["rms_mm"].get<double>(), 0.05) << kind;
    EXPECT_NEAR(report["activations"].value("zygomaticus_minor_left", 0.0), 0.7, 0.03) << kind;
    EXPECT_NEAR(report["activations"].value("jaw_open", 0.0), 0.3, 0.03) << kind;
    for (const char* key : {"error_mm", "iterations", "seconds", "spread", "alike"})
      EXPECT_TRUE(report.contains(key)) << key;
    for (const char* file : {"report/residual.png", "report/residual.ply", "report/report.md"})
      EXPECT_TRUE(fs::exists(at(file))) << file;
    EXPECT_EQ(run("pose " + at("rig.glb") + " --activations " + at("a.json") + " -o " + at("again.obj")).code,
              0);
  }
}

TEST_F(Fit, ToolFitsShapesAndTakes) {
  std::ofstream(at("curves.csv"))
      << "time,zygomaticus_minor_left,jaw_open\n0,0,0\n0.1,0.5,0.1\n0.2,0.6,0.2\n";
  ASSERT_EQ(
      run("play " + at("rig.glb") + " --curves " + at("curves.csv") + " --fps 30 -o " + at("play.glb")).code,
      0);
  const cli::Outcome take =
      run("fit " + at("rig.glb") + " --target " + at("play.glb") + " -o " + at("take.csv") + " --json");
  ASSERT_EQ(take.code, 0) << take.err;
  EXPECT_GT(json::parse(take.out)["share"].get<double>(), 0.99);
  EXPECT_EQ(run("play " + at("rig.glb") + " --curves " + at("take.csv") + " -o " + at("again.glb")).code, 0);

  ASSERT_EQ(run("bake " + at("rig.glb") + " --shapes visemes -o " + at("shapes.glb")).code, 0);
  const cli::Outcome one = run("fit " + at("rig.glb") + " --target " + at("shapes.glb") +
                               " --shape viseme_aa -o " + at("aa.json") + " --json");
  ASSERT_EQ(one.code, 0) << one.err;
  EXPECT_GT(json::parse(one.out)["share"].get<double>(), 0.98);
}

TEST_F(Fit, FramesOfASequenceAreInTheOrderOfTheirNumbers) {
  fs::create_directories(at("sequence"));
  for (const int frame : {1, 2, 10})
    ASSERT_EQ(run("pose " + at("rig.glb") + " --set zygomaticus_minor_left=" + std::to_string(0.05 * frame) +
                  " -o " + at("sequence/frame_" + std::to_string(frame) + ".obj"))
                  .code,
              0);
  const cli::Outcome fitted = run("fit " + at("rig.glb") + " --target " + at("sequence") +
                                  " --smoothness 0 -o " + at("sequence.json") + " --json");
  ASSERT_EQ(fitted.code, 0) << fitted.err;
  std::ifstream file(at("sequence.json"));
  const json curves = json::parse(file);
  const json& curve = curves["zygomaticus_minor_left"]["values"];
  ASSERT_EQ(curve.size(), 3u);
  EXPECT_LT(curve[0].get<double>(), curve[1].get<double>());
  EXPECT_NEAR(curve[2].get<double>(), 0.5, 0.05);
}

/// A head that came as GLB, seen as OBJ: its vertices stand in another order than its faces name them in.
TEST_F(Fit, APosedObjOfAGltfHeadIsTakenInItsOrder) {
  ASSERT_EQ(run("pose " + at("rig.glb") + " -o " + at("rest.glb")).code, 0);
  const cli::Outcome built =
      run("build " + at("rest.glb") + " --detail low -o " + at("gltf.glb") + " --quiet");
  ASSERT_EQ(built.code, 0) << built.err;
  ASSERT_EQ(run("pose " + at("gltf.glb") + " --set zygomaticus_minor_left=0.7 -o " + at("seen.obj")).code, 0);
  const cli::Outcome fitted =
      run("fit " + at("gltf.glb") + " --target " + at("seen.obj") + " -o " + at("a.json") + " --json");
  ASSERT_EQ(fitted.code, 0) << fitted.err;
  EXPECT_GT(json::parse(fitted.out)["share"].get<double>(), 0.99);
}

/// A PC2 cache of the whole OBJ in its own vertex order.
TEST_F(Fit, ToolFitsACache) {
  ASSERT_EQ(run("pose " + at("rig.glb") + " --set zygomaticus_minor_left=0.6 -o " + at("frame.obj")).code, 0);
  std::vector<float> places;
  std::ifstream obj(at("frame.obj"));
  for (std::string line; std::getline(obj, line);)
    if (line.rfind("v ", 0) == 0) {
      float x = 0, y = 0, z = 0;
      ASSERT_EQ(std::sscanf(line.c_str(), "v %f %f %f", &x, &y, &z), 3);
      places.insert(places.end(), {x, y, z});
    }
  std::ofstream file(at("take.pc2"), std::ios::binary);
  const auto put = [&](const auto& value) { file.write(reinterpret_cast<const char*>(&value), 4); };
  file.write("POINTCACHE2", 12);
  put(uint32_t{1});
  put(static_cast<uint32_t>(places.size() / 3));
  put(0.0F);
  put(1.0F);
  put(uint32_t{2});
  for (int frame = 0; frame < 2; ++frame)
    for (const float value : places)
      put(value);
  file.close();
  const cli::Outcome fitted =
      run("fit " + at("rig.glb") + " --target " + at("take.pc2") + " -o " + at("cache.csv") + " --json");
  ASSERT_EQ(fitted.code, 0) << fitted.err;
  EXPECT_GT(json::parse(fitted.out)["share"].get<double>(), 0.99);
}

TEST_F(Fit, ToolReportsInvalidInput) {
  std::ofstream(at("other.obj")) << "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  std::ofstream(at("bad.pc2")) << "POINTCACHE2 and nothing more";
  const auto expect_error = [](const std::string& arguments, const std::string& says) {
    const cli::Outcome outcome = run("fit " + at("rig.glb") + " " + arguments);
    EXPECT_EQ(outcome.code, 1) << arguments << outcome.err;
    EXPECT_NE(outcome.err.find(says), std::string::npos) << arguments << outcome.err;
  };
  expect_error("--target " + at("other.obj") + " -o " + at("x.json"), "topology");
  std::ofstream(at("strange.json"))
      << R"({"landmarks": {"a": [0,0,0], "b": [1,0,0], "c": [0,1,0], "d": [0,0,1]}})";
  expect_error("--target " + at("strange.json") + " -o " + at("x.json"), "landmarks");
  expect_error("--target " + at("bad.pc2") + " -o " + at("x.csv"), "point cache");
  expect_error("--target " + at("head.obj") + " -o " + at("x.csv"), ".json");
  expect_error("--target " + at("head.obj") + " --level none -o " + at("x.json"), "none");
  EXPECT_FALSE(fs::exists(at("x.json")));
}

}  // namespace
}  // namespace fascia::fit
