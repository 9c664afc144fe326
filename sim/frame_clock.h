#pragma once

#include <algorithm>
#include <cmath>

namespace fascia::sim {

/// Frames of any length on substeps of one length: the state runs ahead of the frame to the end of a whole
/// substep, and what is shown lies between its last two states (Fiedler 2004, Fix your timestep). So frames
/// shorter than a substep move in equal steps, and frames of whole substeps show the state itself.
class FrameClock {
 public:
  /// A frame begins: `seconds` pass, of which at most `most` substeps' worth count; the rest is lost. Returns
  /// how many substeps to simulate.
  int begin(double seconds, double substep, int most) {
    substep_ = substep;
    frame_ = std::min(seconds, most * substep);
    before_ = ahead_;
    const double due = (frame_ - ahead_) / substep;
    // Hosts count seconds in single precision: a hair more than whole substeps is whole substeps.
    const int substeps = due <= 0.0 ? 0 : static_cast<int>(std::ceil(due - hair));
    ahead_ += substeps * substep - frame_;
    if (substeps > 0 && std::abs(ahead_) < hair * substep) ahead_ = 0.0;
    return substeps;
  }

  /// Where in the frame, 0 to 1, its substep number `k` (from 0) ends: the time of its drive.
  double share(int k) const {
    const double time = before_ + (k + 1) * substep_;
    return time > frame_ - hair * substep_ ? 1.0 : std::max(0.0, time / frame_);
  }

  /// What is shown lies this share of a substep before the state, 0 to 1.
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
  double ahead_ = 0.0;  ///< seconds from what is shown to the state
};

}  // namespace fascia::sim
