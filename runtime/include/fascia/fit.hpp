/// \file
/// Fascia's runtime for C++20: activations from a stream of landmarks. Included by fascia/fascia.hpp.
#ifndef FASCIA_FIT_HPP
#define FASCIA_FIT_HPP

#include "fascia/asset.hpp"
#include "fascia/fit.h"

namespace fascia::api {

/// Activations and head pose from a stream of landmarks; movable, not copyable. For one thread at a time.
class Fit {
 public:
  /// Points of a detector's landmark set, "ibug68" or "mediapipe478".
  Fit(const Asset& asset, const std::string& set,
      const fascia_fit_options& options = fascia_default_fit_options()) {
    auto landmarks = sized<fascia_fit_landmarks>();
    landmarks.set = set.c_str();
    make(asset, landmarks, options);
  }
  /// Landmarks of the rig by name, one per point of a frame; null for a point that is not used.
  Fit(const Asset& asset, std::span<const char* const> names,
      const fascia_fit_options& options = fascia_default_fit_options()) {
    auto landmarks = sized<fascia_fit_landmarks>();
    landmarks.names = names.data();
    landmarks.count = static_cast<std::uint32_t>(names.size());
    make(asset, landmarks, options);
  }

  /// Points on the skin, one per point of a frame.
  Fit(const Asset& asset, std::span<const fascia_fit_place> places,
      const fascia_fit_options& options = fascia_default_fit_options()) {
    auto landmarks = sized<fascia_fit_landmarks>();
    landmarks.places = places.data();
    landmarks.count = static_cast<std::uint32_t>(places.size());
    make(asset, landmarks, options);
  }

  /// The sizes of frames and results.
  fascia_fit_info info() const {
    auto info = sized<fascia_fit_info>();
    check(fascia_fit_get_info(handle(), &info));
    return info;
  }
  /// Calibrates with a frame of the same face at rest: see fascia_fit_set_neutral. `weights` has one for each
  /// point, or is empty.
  void set_neutral(std::span<const float> points, std::span<const float> weights = {}) {
    check_sizes(points, weights);
    check(fascia_fit_set_neutral(handle(), points.data(), weights.empty() ? nullptr : weights.data()));
  }
  /// Fits the next frame: see fascia_fit_push. The result is valid until the next call.
  fascia_fit_result push(std::span<const float> points, std::span<const float> weights = {}) {
    check_sizes(points, weights);
    auto result = sized<fascia_fit_result>();
    check(fascia_fit_push(handle(), points.data(), weights.empty() ? nullptr : weights.data(), &result));
    return result;
  }
  /// Resets the tracking, as after a cut; the calibration is kept.
  void reset() { check(fascia_fit_reset(handle())); }

  /// The fit in the C interface; not to be released.
  fascia_fit* handle() const { return handle_.get(); }

 private:
  void make(const Asset& asset, const fascia_fit_landmarks& landmarks, const fascia_fit_options& options) {
    fascia_fit* handle = nullptr;
    check(fascia_fit_create(asset.handle(), &landmarks, &options, &handle));
    handle_.reset(handle);
  }
  void check_sizes(std::span<const float> points, std::span<const float> weights) const {
    const fascia_fit_info known = info();
    if (points.size() != std::size_t{known.point_count} * known.dimensions ||
        (!weights.empty() && weights.size() != known.point_count))
      throw Error(FASCIA_ERROR_ARGUMENT, "the points or weights are not as many as a frame has");
  }
  struct Release {
    void operator()(fascia_fit* fit) const { fascia_fit_release(fit); }
  };
  std::unique_ptr<fascia_fit, Release> handle_;
};

}  // namespace fascia::api

#endif
