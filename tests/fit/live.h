// What the tests of live fits share: landmarks of the embedded head's poses as a detector would see them.
#pragma once

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <random>

#include "fascia/fascia.hpp"
#include "fascia/fit.h"
#include "fit/live/head_pose.h"
#include "fit/live/landmark.h"
#include "fit/live/landmark_sets.h"
#include "formats/scene.h"
#include "tests/fit/embedded_subject.h"

namespace fascia::fit {

inline constexpr size_t points = 68;

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
  /// Where a camera that stands upright 0.6 m away, its focal length 1400 pixels, sees a place of a head that
  /// is `turned`.
  inline static const Vec3 camera_shift = Vec3(0.03, -0.02, 0.6);
  static Vec3 pixel(const Mat3& turned, const Vec3& place) {
    const Vec3 seen = turned * place + camera_shift;
    return {1400.0 * seen.x() / seen.z() + 640.0, 1400.0 * seen.y() / seen.z() + 360.0, 0.0};
  }
  static Mat3 before_camera(double yaw) {
    return (Eigen::AngleAxisd(M_PI, Vec3::UnitX()) * Eigen::AngleAxisd(yaw, Vec3::UnitY()))
        .toRotationMatrix();
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

}  // namespace fascia::fit
