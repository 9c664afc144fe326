#pragma once

#include <algorithm>
#include <cmath>
#include <vector>

#include "sim/activation.h"
#include "sim/face_model.h"
#include "sim/quasi_newton.h"

namespace fascia::sim {

enum class StepStatus : uint8_t {
  done = 0,
  reset =
      1  ///< the face diverged, or was driven by numbers that are not finite: it stands at its bones again
};

struct StepResult {
  StepStatus status = StepStatus::done;
  int substeps = 0;
  int iterations = 0;  ///< of all substeps
  double move = 0.0;   ///< metres still wanted by the last substep's solver
};

/// Cuts frames of any length into substeps of one length, so that the frame rate hardly changes the motion,
/// and keeps what must be known from frame to frame: activations between excitations and their dynamics, the
/// controls at the last frame's end, and the time not yet simulated.
class Substeps {
 public:
  /// `channels` is how many activations the face listens to.
  explicit Substeps(size_t channels)
      : excitations_(channels), last_excitations_(channels), activations_(channels) {}

  /// At rest under the bones of `controls`, muscles slack.
  void reset(const Controls& controls) {
    std::fill(activations_.begin(), activations_.end(), 0.0F);
    std::fill(last_excitations_.begin(), last_excitations_.end(), 0.0F);
    last_jaw_ = clamped(controls.jaw);
    last_acceleration_.setZero();
    left_over_ = 0.0;
  }
  /// As though `controls` had acted for ever.
  void settle(const Controls& controls) {
    reset(controls);
    for (size_t c = 0; c < activations_.size(); ++c)
      activations_[c] = controls.activation(c);
    last_excitations_ = activations_;
    last_acceleration_ = controls.acceleration;
  }

  /// Lets `seconds` pass in substeps of `substep` seconds, at most `most` of them (a longer frame loses the
  /// rest), while the controls go from the last frame's to `controls` along a line. `solve(now, result)`
  /// brings the face to the controls `now`, fills in a MinimiseResult and returns false when the face has
  /// diverged. Where the status is `reset` the caller must reset the face, and this.
  template <class Solve>
  StepResult run(double seconds, const Controls& controls, double substep, int most,
                 const ActivationDynamics& dynamics, Solve&& solve) {
    StepResult result;
    if (!std::isfinite(seconds) || !controls.is_finite(activations_.size())) {
      result.status = StepStatus::reset;
      return result;
    }
    if (seconds <= 0.0) return result;
    const double due = left_over_ + seconds;
    const int substeps = static_cast<int>(std::min<double>(due / substep + 1e-9, most));
    for (int k = 0; k < substeps; ++k) {
      // The controls at this substep's own time: before it lie last frame's left-over and k whole substeps.
      const double share = std::clamp(((k + 1) * substep - left_over_) / seconds, 0.0, 1.0);
      MinimiseResult solved;
      const bool is_sound = solve(at(share, controls, substep, dynamics), solved);
      ++result.substeps;
      result.iterations += solved.iterations;
      result.move = solved.move;
      if (!is_sound) {
        result.status = StepStatus::reset;
        return result;
      }
    }
    left_over_ = std::clamp(due - substeps * substep, 0.0, substep);
    for (size_t c = 0; c < last_excitations_.size(); ++c)
      last_excitations_[c] = controls.activation(c);
    last_jaw_ = clamped(controls.jaw);
    last_acceleration_ = controls.acceleration;
    return result;
  }

  std::span<const float> activations() const { return activations_; }  ///< after their dynamics
  double left_over() const { return left_over_; }  ///< seconds of the last frame not yet simulated
  const JawPose& jaw() const { return last_jaw_; }
  const Vec3& acceleration() const { return last_acceleration_; }
  size_t bytes() const { return 3 * sizeof(float) * activations_.size(); }

 private:
  /// The controls at a share of the way from the last frame's to this one's, the activations after `seconds`
  /// more.
  Controls at(double share, const Controls& controls, double seconds, const ActivationDynamics& dynamics) {
    const auto part = static_cast<float>(share);
    for (size_t c = 0; c < excitations_.size(); ++c) {
      const float goal = c < controls.activations.size() ? controls.activations[c] : 0.0F;
      excitations_[c] = last_excitations_[c] + part * (goal - last_excitations_[c]);
    }
    follow(dynamics, seconds, excitations_, activations_);
    const auto mix = [part](float from, float to) { return from + part * (to - from); };
    const JawPose goal = clamped(controls.jaw);
    return {activations_,
            {mix(last_jaw_.open, goal.open), mix(last_jaw_.forward, goal.forward),
             mix(last_jaw_.lateral, goal.lateral)},
            last_acceleration_ + share * (controls.acceleration - last_acceleration_),
            controls.touches};
  }

  std::vector<float> excitations_, last_excitations_, activations_;
  JawPose last_jaw_;
  Vec3 last_acceleration_ = Vec3::Zero();
  double left_over_ = 0.0;
};

}  // namespace fascia::sim
