#pragma once

#include <algorithm>
#include <cmath>

namespace fascia::sim {

/// Maps frames of any length to substeps of fixed length: the state is ahead of the frame, at the end of a
/// complete substep, and the displayed positions are interpolated between the last two states (Fiedler 2004,
/// Fix your timestep). Frames shorter than a substep thus move evenly, and frames of whole substeps display
/// the state itself.
class FrameClock {
 public:
  /// Begins a frame of `seconds`, truncated to `most` substeps. Returns the number of substeps to simulate.
  int begin(double seconds, double substep, int most) {
    substep_ = substep;
    frame_ = std::min(seconds, most * substep);
    before_ = ahead_;
    const double due = (frame_ - ahead_) / substep;
    // Hosts use single precision: slightly more than a whole number of substeps is rounded down.
    const int substeps = due <= 0.0 ? 0 : static_cast<int>(std::ceil(due - hair));
    ahead_ += substeps * substep - frame_;
    if (substeps > 0 && std::abs(ahead_) < hair * substep) ahead_ = 0.0;
    return substeps;
  }

  /// Position in the frame, 0 to 1, of the end of substep `k` (from 0), at which its controls are evaluated.
  double share(int k) const {
    const double time = before_ + (k + 1) * substep_;
    return time > frame_ - hair * substep_ ? 1.0 : std::max(0.0, time / frame_);
  }

  /// Fraction of a substep, 0 to 1, by which the displayed positions lag behind the state.
  double back() const { return substep_ > 0.0 ? std::clamp(ahead_ / substep_, 0.0, 1.0) : 0.0; }

  void reset() { ahead_ = 0.0; }

  /// See sim::StateBytes.
  template <class Bytes>
  void exchange_state(Bytes& bytes) {
    bytes.value(substep_);
    bytes.value(frame_);
    bytes.value(before_);
    bytes.value(ahead_);
  }

 private:
  static constexpr double hair = 1e-3;  ///< of a substep
  double substep_ = 0.0, frame_ = 0.0, before_ = 0.0;
  double ahead_ = 0.0;  ///< seconds from the displayed time to the state
};

}  // namespace fascia::sim
