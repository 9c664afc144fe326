#pragma once

#include <span>
#include <vector>

#include "sim/jaw.h"

namespace fascia::sim {

/// A muscle that moves the mandible: a straight pull from a fixed place to one on the mandible.
struct JawMuscle {
  uint32_t channel = 0;
  Vec3 origin = Vec3::Zero(),
       insertion = Vec3::Zero();  ///< metres, at rest; the insertion goes with the mandible
  double strength = 0.0;          ///< newton at full activation
};

/// How masticatory muscles move the jaw: each one's pull times its lever on each of the joint's three
/// motions, against a joint whose stiffness is such that all openers together open it to 1, all protruders
/// bring it forward to 1, and one side's lateral pull turns it to 1. Levers are those of the rest pose.
class JawMuscles {
 public:
  JawMuscles() = default;
  JawMuscles(const Jaw& jaw, std::span<const JawMuscle> muscles);
  /// `pose` with what the muscles add, within the joint's limits. `activations` one a channel.
  JawPose moved(const JawPose& pose, std::span<const float> activations) const;
  bool empty() const { return levers_.empty(); }

 private:
  struct Lever {
    uint32_t channel;
    Vec3 by;  ///< open, forward, lateral at full activation
  };
  std::vector<Lever> levers_;
};

}  // namespace fascia::sim
