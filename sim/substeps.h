#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "sim/activation.h"
#include "sim/face_model.h"
#include "sim/frame_clock.h"
#include "sim/quasi_newton.h"
#include "sim/state_bytes.h"

namespace fascia::sim {

enum class StepStatus : uint8_t {
  done = 0,
  reset = 1  ///< the face diverged, or its controls were not finite: it was reset to rest
};

struct StepResult {
  StepStatus status = StepStatus::done;
  int substeps = 0;
  int iterations = 0;  ///< of all substeps
  double move = 0.0;   ///< metres: residual step of the last substep
};

/// Linear interpolation between two poses; at 0 exactly `from`.
inline JawPose between(const JawPose& from, const JawPose& to, double share) {
  const auto mix = [share](float a, float b) { return a + static_cast<float>(share) * (b - a); };
  return {mix(from.open, to.open), mix(from.forward, to.forward), mix(from.lateral, to.lateral)};
}

/// Divides frames of any length into substeps of fixed length, so that the motion hardly depends on the frame
/// rate, and stores the state between frames: activations, the controls at the end of the last frame, and the
/// time by which the state is ahead of the frame.
class Substeps {
 public:
  /// `channels` is the number of activations.
  explicit Substeps(size_t channels)
      : excitations_(channels), last_excitations_(channels), activations_(channels) {}

  /// At rest on the bones of `controls`, without activation.
  void reset(const Controls& controls) {
    std::fill(activations_.begin(), activations_.end(), 0.0F);
    std::fill(last_excitations_.begin(), last_excitations_.end(), 0.0F);
    last_jaw_ = clamped(controls.jaw);
    last_acceleration_.setZero();
    jaw_before_ = jaw_now_ = last_jaw_;
    clock_.reset();
  }
  /// In the steady state of `controls`.
  void settle(const Controls& controls) {
    reset(controls);
    for (size_t c = 0; c < activations_.size(); ++c)
      activations_[c] = controls.activation(c);
    last_excitations_ = activations_;
    last_acceleration_ = controls.acceleration;
  }

  /// Advances by `seconds` in substeps of `substep` seconds, at most `most` of them (longer frames are
  /// truncated), with controls interpolated linearly from the last frame's to `controls`. `solve(now,
  /// result)` solves a substep with the controls `now`, fills in a MinimiseResult and returns false if the
  /// face has diverged. If the status is `reset` the caller must reset the face, and this object.
  template <class Solve>
  StepResult run(double seconds, const Controls& controls, double substep, int most,
                 const ActivationDynamics& dynamics, Solve&& solve) {
    StepResult result;
    if (!std::isfinite(seconds) || !controls.is_finite(activations_.size())) {
      result.status = StepStatus::reset;
      return result;
    }
    if (seconds <= 0.0) return result;
    const int substeps = clock_.begin(seconds, substep, most);
    for (int k = 0; k < substeps; ++k) {
      const Controls now = at(clock_.share(k), controls, substep, dynamics);
      jaw_before_ = jaw_now_;
      jaw_now_ = now.jaw;
      MinimiseResult solved;
      const bool is_sound = solve(now, solved);
      ++result.substeps;
      result.iterations += solved.iterations;
      result.move = solved.move;
      if (!is_sound) {
        result.status = StepStatus::reset;
        return result;
      }
    }
    for (size_t c = 0; c < last_excitations_.size(); ++c)
      last_excitations_[c] = controls.activation(c);
    last_jaw_ = clamped(controls.jaw);
    last_acceleration_ = controls.acceleration;
    return result;
  }

  /// See StateBytes. False if the values read are implausible.
  bool exchange_state(StateBytes& bytes) {
    bytes.list(last_excitations_.data(), last_excitations_.size());
    bytes.list(activations_.data(), activations_.size());
    for (JawPose* jaw : {&last_jaw_, &jaw_before_, &jaw_now_})
      bytes.value(*jaw);
    bytes.value(last_acceleration_);
    clock_.exchange_state(bytes);
    return !bytes.reads() || (clock_.back() >= 0.0 && clock_.back() <= 1.0);
  }

  std::span<const float> activations() const { return activations_; }  ///< after their dynamics
  /// Fraction of a substep, 0 to 1, by which the displayed positions lag behind the state, toward the
  /// previous one.
  double back() const { return clock_.back(); }
  /// The jaw there.
  JawPose shown_jaw() const { return between(jaw_now_, jaw_before_, clock_.back()); }
  const JawPose& jaw() const { return last_jaw_; }
  const Vec3& acceleration() const { return last_acceleration_; }
  size_t bytes() const { return 3 * sizeof(float) * activations_.size(); }

 private:
  /// The controls interpolated between the last frame's and this one's, with activations advanced by
  /// `seconds`.
  Controls at(double share, const Controls& controls, double seconds, const ActivationDynamics& dynamics) {
    const auto part = static_cast<float>(share);
    for (size_t c = 0; c < excitations_.size(); ++c) {
      const float goal = c < controls.activations.size() ? controls.activations[c] : 0.0F;
      excitations_[c] = last_excitations_[c] + part * (goal - last_excitations_[c]);
    }
    follow(dynamics, seconds, excitations_, activations_);
    const JawPose goal = clamped(controls.jaw);
    return {activations_, share < 1.0 ? between(last_jaw_, goal, share) : goal,
            last_acceleration_ + share * (controls.acceleration - last_acceleration_), controls.touches};
  }

  std::vector<float> excitations_, last_excitations_, activations_;
  JawPose last_jaw_;
  Vec3 last_acceleration_ = Vec3::Zero();
  FrameClock clock_;
  JawPose jaw_before_, jaw_now_;  ///< of the last two states
};

}  // namespace fascia::sim
