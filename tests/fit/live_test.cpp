// Activations from streams of landmarks, through the C interface, on the embedded head at low detail.
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>
#include <random>

#include "fascia/fascia.hpp"
#include "fascia/fit.h"
#include "fit/live/head_pose.h"
#include "fit/live/landmark.h"
#include "fit/live/landmark_sets.h"
#include "formats/scene.h"
#include "tests/fit/embedded_subject.h"

namespace fascia::fit {
namespace {

constexpr size_t points = 68;

/// What a detector would see of a face: all 68 points, those without a landmark of ours unseen.
struct Seen {
  std::vector<float> places, weights;
};

class Live : public EmbeddedSubject {
 protected:
  static void SetUpTestSuite() {
    EmbeddedSubject::SetUpTestSuite();
    const std::vector<uint8_t> bytes = formats::read_bytes(at("rig.glb"));
    ASSERT_EQ(fascia_asset_load(bytes.data(), bytes.size(), &asset), FASCIA_OK) << fascia_last_message();
    const LandmarkSet set = find_landmark_set("ibug68").value();
    for (const LandmarkSet::Entry& entry : set.entries)
      if (const auto place = place_of_landmark(subject->file(), 0, entry.landmark))
        landmarks.push_back({entry, landmark_at(subject->file(), 0, *place)});
    ASSERT_EQ(landmarks.size(), 35U);
  }
  static void TearDownTestSuite() {
    landmarks.clear();
    fascia_asset_release(asset);
    EmbeddedSubject::TearDownTestSuite();
  }

  struct Known {
    LandmarkSet::Entry entry;
    Landmark landmark;
  };
  inline static fascia_asset* asset = nullptr;
  inline static std::vector<Known> landmarks;

  /// Where the landmarks of the subject's last pose are, metres.
  static std::vector<Vec3> standing() {
    std::vector<Vec3> places;
    for (const Known& known : landmarks) {
      Vec3 place = known.landmark.rest;
      for (const auto& [node, weight] : known.landmark.influences)
        place += weight * (subject->nodes()[node] - subject->model().rest()[node]);
      places.push_back(place);
    }
    return places;
  }
  static std::vector<Vec3> places_of(const std::vector<float>& values, bool warm) {
    subject->pose(values, warm);
    return standing();
  }
  static Seen seen(const std::vector<Vec3>& places, const std::function<Vec3(const Vec3&)>& by = nullptr,
                   int numbers = 3) {
    Seen out{std::vector<float>(points * static_cast<size_t>(numbers), NAN),
             std::vector<float>(points, 0.0F)};
    for (size_t l = 0; l < landmarks.size(); ++l)
      for (const uint32_t p : landmarks[l].entry.points) {
        const Vec3 place = by ? by(places[l]) : places[l];
        for (int k = 0; k < numbers; ++k)
          out.places[static_cast<size_t>(numbers) * p + static_cast<size_t>(k)] =
              static_cast<float>(place[k]);
        out.weights[p] = 1.0F;
      }
    return out;
  }
  static bool is_of_mouth(const std::string& name) {
    for (const char* part : {"labiale", "crista", "cheilion", "menton"})
      if (name.rfind(part, 0) == 0) return true;
    return false;
  }

  /// Half a second to come up, then brows, a smile, the jaw and a blink go their ways.
  static std::vector<float> values_at(double seconds) {
    const auto wave = [&](double size, double speed, double phase) {
      return static_cast<float>(std::min(1.0, 2.0 * seconds) *
                                std::max(0.0, size * std::sin(speed * seconds + phase)));
    };
    return values_of({{"jaw_open", wave(0.4, 3.1, 0.3)},
                      {"zygomaticus_major_superior_left", wave(0.8, 2.3, 1.0)},
                      {"zygomaticus_major_superior_right", wave(0.6, 2.3, 0.8)},
                      {"depressor_anguli_oris_left", wave(0.5, 1.7, 4.0)},
                      {"frontalis_medial_left", wave(0.7, 2.9, 0.0)},
                      {"frontalis_medial_right", wave(0.7, 2.9, 0.2)},
                      {"corrugator_supercilii_transverse_left", wave(0.6, 2.1, 3.5)}});
  }

  struct Fit {
    explicit Fit(const fascia_fit_options* options = nullptr) {
      fascia_fit_landmarks given{};
      given.struct_size = sizeof given;
      given.set = "ibug68";
      EXPECT_EQ(fascia_fit_create(asset, &given, options, &fit), FASCIA_OK) << fascia_last_message();
    }
    ~Fit() { fascia_fit_release(fit); }
    Fit(const Fit&) = delete;
    Fit& operator=(const Fit&) = delete;
    fascia_fit_result push(const Seen& frame) {
      fascia_fit_result result{};
      result.struct_size = sizeof result;
      EXPECT_EQ(fascia_fit_push(fit, frame.places.data(), frame.weights.data(), &result), FASCIA_OK)
          << fascia_last_message();
      return result;
    }
    /// The fitted landmarks in the head's metres.
    static std::vector<Vec3> fitted(const fascia_fit_result& result) {
      const Eigen::Matrix4d back = Eigen::Map<const Eigen::Matrix4f>(result.head).cast<double>().inverse();
      std::vector<Vec3> places;
      for (size_t l = 0; l < landmarks.size(); ++l)
        places.push_back(transform_point(
            back, Eigen::Map<const Eigen::Vector3f>(result.landmarks + 3 * l).cast<double>()));
      return places;
    }
    fascia_fit* fit = nullptr;
  };
  static double rms_mm(const std::vector<Vec3>& a, const std::vector<Vec3>& b) {
    double sum = 0.0;
    for (size_t i = 0; i < a.size(); ++i)
      sum += (a[i] - b[i]).squaredNorm();
    return 1e3 * std::sqrt(sum / static_cast<double>(a.size()));
  }
  /// Share of the skin's motion over a take that is found again, and the root mean square miss of landmarks.
  struct Outcome {
    double share = 0.0, landmarks_mm = 0.0, motion_mm = 0.0;
  };
  static Outcome follow_take(Fit& fit, double noise_mm, int frames) {
    std::mt19937 random(3);
    std::normal_distribution<double> noise(0.0, 1e-3 * noise_mm / std::sqrt(3.0));
    double left = 0.0, whole = 0.0, miss = 0.0, motion = 0.0;
    const std::vector<Vec3> rest = places_of(values_at(0.0), false);
    for (int frame = 0; frame < frames; ++frame) {
      const double seconds = frame / 30.0;
      const std::vector<Vec3> places = places_of(values_at(seconds), true);
      const Eigen::VectorXd truth = subject->displacements(values_at(seconds));
      const HeadPose head{Eigen::AngleAxisd(0.4 * std::sin(2.0 * seconds), Vec3::UnitY()).toRotationMatrix(),
                          Vec3(0.05 * std::sin(seconds), 0.02, 0.5), 1.1};
      const fascia_fit_result result = fit.push(seen(places, [&](const Vec3& p) {
        return head * (p + Vec3(noise(random), noise(random), noise(random)));
      }));
      if (frame < 3) continue;
      miss += std::pow(rms_mm(Fit::fitted(result), places), 2);
      motion += std::pow(rms_mm(rest, places), 2);
      const std::vector<float> values(result.values, result.values + subject->channels().size());
      subject->pose(values, false);
      const Eigen::VectorXd found = subject->displacements(values);
      left += (found - truth).squaredNorm();
      whole += truth.squaredNorm();
      subject->pose(values_at(seconds), true);
    }
    return {1.0 - left / whole, std::sqrt(miss / (frames - 3)), std::sqrt(motion / (frames - 3))};
  }
};

TEST_F(Live, FollowsATakeOfItsOwn) {
  Fit fit;
  const Outcome outcome = follow_take(fit, 0.0, 60);
  RecordProperty("landmarks_mm", std::to_string(outcome.landmarks_mm));
  EXPECT_GT(outcome.motion_mm, 2.0);
  EXPECT_LT(outcome.landmarks_mm, 0.2);  // far below what a detector knows
  EXPECT_GT(outcome.share, 0.97);
}

/// With noise, the fitted landmarks are nearer to the truth than the points are.
TEST_F(Live, TakesNoiseOutOfATake) {
  Fit fit;
  const Outcome outcome = follow_take(fit, 0.5, 60);
  EXPECT_LT(outcome.landmarks_mm, 0.5);
  EXPECT_GT(outcome.share, 0.9);
}

TEST_F(Live, FindsWhereTheHeadIs) {
  Fit fit;
  const std::vector<Vec3> places = places_of(values_of({{"jaw_open", 0.3F}}), false);
  const Mat3 turn = Eigen::AngleAxisd(0.7, Vec3(0.2, 1.0, 0.1).normalized()).toRotationMatrix();
  const Vec3 shift(3.0, -2.0, 40.0);
  const double scale = 110.0;  // centimetres, and a larger face
  fascia_fit_result result{};
  for (int i = 0; i < 4; ++i)
    result = fit.push(seen(places, [&](const Vec3& p) { return Vec3(scale * (turn * p) + shift); }));
  const Eigen::Matrix4d head = Eigen::Map<const Eigen::Matrix4f>(result.head).cast<double>();
  EXPECT_NEAR(result.scale, scale, 0.005 * scale);
  EXPECT_LT(Eigen::AngleAxisd(Mat3(turn.transpose() * head.topLeftCorner<3, 3>() / result.scale)).angle(),
            0.01);
  const Vec3 middle(0.0, 0.0, 0.1);
  EXPECT_LT((transform_point(head, middle) - (scale * (turn * middle) + shift)).norm() / scale, 1e-3);
  EXPECT_NEAR(result.values[subject->channel("jaw_open")], 0.3, 0.05);
  EXPECT_LT(result.residual, 2e-4F);
  EXPECT_EQ(result.seen, landmarks.size());
}

/// The mouth stands open and is hidden for a second while brows and head move on: it stays as it was.
TEST_F(Live, WhatIsHiddenHolds) {
  Fit fit;
  std::mt19937 random(5);
  std::normal_distribution<double> noise(0.0, 2e-4);
  std::vector<Vec3> before;
  std::vector<float> jaw;
  for (int frame = 0; frame < 50; ++frame) {
    const auto brows = static_cast<float>(0.4 - 0.4 * std::cos(0.3 * frame));
    const std::vector<Vec3> places = places_of(values_of({{"jaw_open", 0.35F},
                                                          {"zygomaticus_major_superior_left", 0.5F},
                                                          {"frontalis_medial_left", brows},
                                                          {"frontalis_medial_right", brows}}),
                                               frame > 0);
    const HeadPose head{Eigen::AngleAxisd(0.01 * frame, Vec3::UnitY()).toRotationMatrix(), Vec3::Zero(), 1.0};
    Seen now = seen(places, [&](const Vec3& p) {
      return head * (p + Vec3(noise(random), noise(random), noise(random)));
    });
    const bool is_hidden = frame >= 20;
    for (const Known& known : landmarks)
      if (is_hidden && is_of_mouth(known.entry.landmark))
        for (const uint32_t p : known.entry.points) {
          now.weights[p] = 0.0F;
          now.places[3 * p] = 9.0F;  // whatever stands there
        }
    const fascia_fit_result result = fit.push(now);
    const std::vector<Vec3> fitted = Fit::fitted(result);
    if (frame == 19) before = fitted;
    if (frame < 20) continue;
    EXPECT_LT(result.seen, landmarks.size());
    for (size_t l = 0; l < landmarks.size(); ++l)
      EXPECT_LT((fitted[l] - places[l]).norm(), is_of_mouth(landmarks[l].entry.landmark) ? 1.5e-3 : 1.0e-3)
          << frame << " " << landmarks[l].entry.landmark;
  }
}

TEST_F(Live, SeesThroughACamera) {
  fascia_fit_options options = fascia_default_fit_options();
  options.focal[0] = options.focal[1] = 1400.0F;
  options.centre[0] = 640.0F;
  options.centre[1] = 360.0F;
  Fit fit(&options);
  fascia_fit_info info{};
  info.struct_size = sizeof info;
  ASSERT_EQ(fascia_fit_get_info(fit.fit, &info), FASCIA_OK);
  EXPECT_EQ(info.dimensions, 2U);
  for (int frame = 0; frame < 30; ++frame) {
    const double seconds = frame / 30.0;
    const std::vector<Vec3> places = places_of(values_at(seconds), frame > 0);
    const Mat3 turn =
        (Eigen::AngleAxisd(M_PI, Vec3::UnitX()) * Eigen::AngleAxisd(0.3 * seconds, Vec3::UnitY()))
            .toRotationMatrix();
    const Vec3 shift(0.03, -0.02, 0.6);
    const auto pixel = [&](const Vec3& p) {
      const Vec3 c = turn * p + shift;
      return Vec3(1400.0 * c.x() / c.z() + 640.0, 1400.0 * c.y() / c.z() + 360.0, 0.0);
    };
    const fascia_fit_result result = fit.push(seen(places, pixel, 2));
    if (frame < 3) continue;
    const Eigen::Matrix4d head = Eigen::Map<const Eigen::Matrix4f>(result.head).cast<double>();
    EXPECT_LT(Eigen::AngleAxisd(Mat3(turn.transpose() * head.topLeftCorner<3, 3>())).angle(), 0.02) << frame;
    EXPECT_NEAR(head(2, 3), shift.z(), 0.02) << frame;
    EXPECT_LT(result.residual, 3e-4F) << frame;
    EXPECT_LT(rms_mm(Fit::fitted(result), places), 1.0) << frame;
  }
}

/// A detector that puts its points elsewhere than ours, on a face of other proportions.
TEST_F(Live, ANeutralFrameTakesOutTheDetectorsOwnPlaces) {
  const std::vector<Vec3> rest = places_of(values_of({}), false);
  const std::vector<Vec3> places = places_of(values_of({{"zygomaticus_major_superior_left", 0.6F}}), false);
  const auto elsewhere = [](std::vector<Vec3> list) {
    for (size_t l = 0; l < list.size(); ++l)
      list[l] +=
          4e-3 * Vec3(std::sin(7.0 * static_cast<double>(l)), std::cos(5.0 * static_cast<double>(l)), 0.0);
    return list;
  };
  Fit fit;
  const Seen neutral = seen(elsewhere(rest));
  ASSERT_EQ(fascia_fit_set_neutral(fit.fit, neutral.places.data(), neutral.weights.data()), FASCIA_OK)
      << fascia_last_message();
  fascia_fit_result result = fit.push(neutral);
  EXPECT_LT(result.residual, 1e-4F);
  for (size_t c = 0; c < subject->channels().size(); ++c)
    EXPECT_NEAR(result.values[c], subject->channels()[c].rest, 0.02) << subject->channels()[c].name;
  for (int i = 0; i < 4; ++i)
    result = fit.push(seen(elsewhere(places)));
  EXPECT_LT(result.residual, 3e-4F);
  // After a cut the neutral still holds.
  ASSERT_EQ(fascia_fit_reset(fit.fit), FASCIA_OK);
  EXPECT_LT(fit.push(neutral).residual, 1e-4F);
}

TEST_F(Live, SameFramesSameAnswer) {
  std::vector<float> values[2];
  for (std::vector<float>& list : values) {
    Fit fit;
    for (int frame = 0; frame < 20; ++frame) {
      const fascia_fit_result result = fit.push(seen(places_of(values_at(frame / 15.0), frame > 0)));
      list.assign(result.values, result.values + subject->channels().size());
    }
  }
  EXPECT_EQ(values[0], values[1]);
}

TEST_F(Live, SeesNothingAndHolds) {
  Fit fit;
  const Seen frame = seen(places_of(values_of({{"jaw_open", 0.3F}}), false));
  const fascia_fit_result first = fit.push(frame);
  const std::vector<float> values(first.values, first.values + subject->channels().size());
  Seen nothing = frame;
  std::fill(nothing.weights.begin(), nothing.weights.end(), 0.0F);
  const fascia_fit_result result = fit.push(nothing);
  EXPECT_EQ(result.seen, 0U);
  EXPECT_EQ(std::vector<float>(result.values, result.values + values.size()), values);
  Fit fresh;
  EXPECT_EQ(fresh.push(nothing).seen, 0U);
}

/// The same through the C++ wrapper, by landmarks' names.
TEST_F(Live, ByNamesInCpp) {
  const std::vector<uint8_t> bytes = formats::read_bytes(at("rig.glb"));
  std::vector<const char*> names;
  std::vector<float> places;
  const std::vector<Vec3> standing = places_of(values_of({{"jaw_open", 0.3F}}), false);
  for (size_t l = 0; l < landmarks.size(); ++l) {
    names.push_back(landmarks[l].entry.landmark.c_str());
    for (int k = 0; k < 3; ++k)
      places.push_back(static_cast<float>(standing[l][k]));
  }
  const api::Asset rig = api::Asset::load(bytes);
  api::Fit fit(rig, names);
  EXPECT_EQ(fit.info().point_count, names.size());
  EXPECT_STREQ(fit.info().names[0], names[0]);
  EXPECT_NEAR(fit.push(places).values[subject->channel("jaw_open")], 0.3, 0.05);
  places.pop_back();
  EXPECT_THROW(fit.push(places), api::Error);
  EXPECT_THROW(api::Fit(rig, "unknown"), api::Error);
}

/// The tool takes detectors' mark-ups, and says so of others.
TEST_F(Live, ToolFitsPointsOfDetectors) {
  const std::vector<Vec3> standing = places_of(values_of({{"jaw_open", 0.35F}}), false);
  const Mat4 to_file = subject->file().rig.input_to_metres.cast<double>().inverse();
  const LandmarkSet set = find_landmark_set("mediapipe478").value();
  nlohmann::json list(set.points, nullptr);
  for (const LandmarkSet::Entry& entry : set.entries)
    for (size_t l = 0; l < landmarks.size(); ++l)
      if (landmarks[l].entry.landmark == entry.landmark)
        for (const uint32_t p : entry.points) {
          const Vec3 place = transform_point(to_file, standing[l]);
          list[p] = {place.x(), place.y(), place.z()};
        }
  std::ofstream(at(set.name + ".json")) << nlohmann::json{{"points", list}};
  const cli::Outcome fitted =
      run("fit " + at("rig.glb") + " --target " + at(set.name + ".json") + " -o " + at("a.json") + " --json");
  ASSERT_EQ(fitted.code, 0) << fitted.err;
  const nlohmann::json report = nlohmann::json::parse(fitted.out);
  EXPECT_NEAR(report["activations"].value("jaw_open", 0.0), 0.35, 0.05) << set.name;
  EXPECT_LT(report["rms_mm"].get<double>(), 0.3) << set.name;
  std::ofstream(at("few.json")) << R"({"points": [[0,0,0],[1,0,0]]})";
  const cli::Outcome refused =
      run("fit " + at("rig.glb") + " --target " + at("few.json") + " -o " + at("a.json"));
  EXPECT_EQ(refused.code, 1);
  EXPECT_NE(refused.err.find("478"), std::string::npos) << refused.err;
}

/// Landmarks in the pictures of a camera, one face and a take; the file says nothing of where the head is.
TEST_F(Live, ToolFitsPictures) {
  const Mat3 turn =
      (Eigen::AngleAxisd(M_PI, Vec3::UnitX()) * Eigen::AngleAxisd(0.3, Vec3::UnitY())).toRotationMatrix();
  const auto pictured = [&](const std::vector<Vec3>& places) {
    nlohmann::json list(points, nullptr);
    for (size_t l = 0; l < landmarks.size(); ++l)
      for (const uint32_t p : landmarks[l].entry.points) {
        const Vec3 c = turn * places[l] + Vec3(0.03, -0.02, 0.6);
        list[p] = {1400.0 * c.x() / c.z() + 640.0, 1400.0 * c.y() / c.z() + 360.0};
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
  EXPECT_GT(nlohmann::json::parse(take.out)["share"].get<double>(), 0.95);
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

TEST_F(Live, SaysWhatIsWrong) {
  fascia_fit_landmarks given{};
  given.struct_size = sizeof given;
  fascia_fit* made = nullptr;
  const auto create = [&](const fascia_fit_options* options = nullptr) {
    return fascia_fit_create(asset, &given, options, &made);
  };
  EXPECT_EQ(create(), FASCIA_ERROR_ARGUMENT);  // neither set nor names nor places
  given.set = "ibug86";
  EXPECT_EQ(create(), FASCIA_ERROR_NAME);
  EXPECT_NE(std::string(fascia_last_message()).find("mediapipe478"), std::string::npos);
  given.set = "ibug68";
  given.count = 5;
  EXPECT_EQ(create(), FASCIA_ERROR_ARGUMENT);
  given.count = 0;
  EXPECT_EQ(fascia_fit_create(nullptr, &given, nullptr, &made), FASCIA_ERROR_ARGUMENT);
  EXPECT_EQ(fascia_fit_create(asset, nullptr, nullptr, &made), FASCIA_ERROR_ARGUMENT);
  EXPECT_EQ(fascia_fit_create(asset, &given, nullptr, nullptr), FASCIA_ERROR_ARGUMENT);
  fascia_fit_options options = fascia_default_fit_options();
  for (const auto& spoil : std::vector<std::function<void(fascia_fit_options&)>>{
           [](auto& o) { o.level = 9; }, [](auto& o) { o.iterations = 0; }, [](auto& o) { o.ridge = -1.0F; },
           [](auto& o) { o.smoothness = NAN; }, [](auto& o) { o.focal[0] = -5.0F; },
           [](auto& o) { o.focal[0] = 1000.0F; }, [](auto& o) { o.struct_size = 0; }}) {
    fascia_fit_options bad = options;
    spoil(bad);
    EXPECT_EQ(create(&bad), FASCIA_ERROR_ARGUMENT);
  }
  given.set = nullptr;
  const char* names[] = {"pronasale", "menton", nullptr, "cheilion_left", "nobody"};
  given.names = names;
  given.count = 5;
  EXPECT_EQ(create(), FASCIA_ERROR_NAME);
  given.count = 4;
  EXPECT_EQ(create(), FASCIA_ERROR_ARGUMENT);  // three landmarks
  given.names = nullptr;
  fascia_fit_place places[4] = {};
  for (fascia_fit_place& place : places)
    place.shares[0] = 1.0F;
  given.places = places;
  for (const auto& spoil : std::vector<std::function<void()>>{
           [&] { places[1].vertices[0] = 1U << 30U; }, [&] { places[1].shares[1] = 0.5F; },
           [&] { places[1].shares[0] = NAN; }, [&] { places[1].mesh = 1000; }}) {
    const fascia_fit_place kept = places[1];
    spoil();
    EXPECT_EQ(create(), FASCIA_ERROR_ARGUMENT);
    places[1] = kept;
  }
  EXPECT_EQ(made, nullptr);
  EXPECT_EQ(fascia_fit_push(nullptr, nullptr, nullptr, nullptr), FASCIA_ERROR_ARGUMENT);
  EXPECT_EQ(fascia_fit_reset(nullptr), FASCIA_ERROR_ARGUMENT);
  fascia_fit_release(nullptr);

  Fit fit;
  Seen frame = seen(places_of(values_of({}), false));
  EXPECT_EQ(fascia_fit_push(fit.fit, nullptr, nullptr, nullptr), FASCIA_ERROR_ARGUMENT);
  fascia_fit_result unsized{};
  EXPECT_EQ(fascia_fit_push(fit.fit, frame.places.data(), nullptr, &unsized), FASCIA_ERROR_ARGUMENT);
  frame.weights[3] = -1.0F;
  EXPECT_EQ(fascia_fit_push(fit.fit, frame.places.data(), frame.weights.data(), nullptr),
            FASCIA_ERROR_ARGUMENT);
  std::fill(frame.weights.begin(), frame.weights.end(), 0.0F);
  EXPECT_EQ(fascia_fit_set_neutral(fit.fit, frame.places.data(), frame.weights.data()),
            FASCIA_ERROR_ARGUMENT);
}

}  // namespace
}  // namespace fascia::fit
