// Activations from streams of landmarks, through the C interface, on the embedded head at low detail.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "tests/fit/live.h"

namespace fascia::fit {
namespace {

TEST_F(Live, FollowsATakeOfItsOwn) {
  Fit fit;
  const Outcome outcome = follow_take(fit, 0.0, 60);
  RecordProperty("landmarks_mm", std::to_string(outcome.landmarks_mm));
  EXPECT_GT(outcome.motion_mm, 2.0);
  EXPECT_LT(outcome.landmarks_mm, 0.2);  // far below what a detector knows
  EXPECT_GT(outcome.share, 0.97);
}

/// With noise, the fitted landmarks are nearer to the truth than the points are.
TEST_F(Live, SmoothsNoiseInATake) {
  Fit fit;
  const Outcome outcome = follow_take(fit, 0.5, 60);
  EXPECT_LT(outcome.landmarks_mm, 0.5);
  EXPECT_GT(outcome.share, 0.9);
}

TEST_F(Live, FindsTheHeadPose) {
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
TEST_F(Live, KeepsPoseOfHiddenParts) {
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
    const Mat3 turn = before_camera(0.3 * seconds);
    const fascia_fit_result result = fit.push(seen(
        places, [&](const Vec3& p) { return pixel(turn, p); }, 2));
    if (frame < 3) continue;
    const Eigen::Matrix4d head = Eigen::Map<const Eigen::Matrix4f>(result.head).cast<double>();
    EXPECT_LT(Eigen::AngleAxisd(Mat3(turn.transpose() * head.topLeftCorner<3, 3>())).angle(), 0.02) << frame;
    EXPECT_NEAR(head(2, 3), camera_shift.z(), 0.02) << frame;
    EXPECT_LT(result.residual, 3e-4F) << frame;
    EXPECT_LT(rms_mm(Fit::fitted(result), places), 1.0) << frame;
  }
}

/// A detector that puts its points elsewhere than ours, on a face of other proportions.
TEST_F(Live, ANeutralFrameRemovesTheDetectorsBias) {
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

TEST_F(Live, IsDeterministic) {
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

TEST_F(Live, KeepsPoseWithoutLandmarks) {
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

TEST_F(Live, ReportsInvalidInput) {
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
