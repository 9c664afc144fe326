#pragma once

#include <span>
#include <type_traits>
#include <vector>

#include "sim/jaw.h"

namespace fascia::sim {

/// A muscle that moves the mandible: a straight line of action from a fixed point to one on the mandible.
struct JawMuscle {
  uint32_t channel = 0;
  Vec3 origin = Vec3::Zero(),
       insertion = Vec3::Zero();  ///< metres, at rest; the insertion moves with the mandible
  double strength = 0.0;          ///< newton at full activation
};

/// Motion of the jaw by the muscles of mastication: the force of each times its lever arm for each of the
/// joint's three motions, against a joint stiffness such that all openers together open it to 1, all
/// protruders protrude it to 1, and the lateral muscles of one side move it to 1. Lever arms are those of the
/// rest pose.
class JawMuscles {
 public:
  JawMuscles() = default;
  JawMuscles(const Jaw& jaw, std::span<const JawMuscle> muscles);
  /// `pose` plus the muscles' contribution, within the joint's limits. `activations` one per channel.
  JawPose moved(const JawPose& pose, std::span<const float> activations) const;
  bool empty() const { return levers_.empty(); }

 private:
  struct Lever {
    uint32_t channel;
    Vec3 by;  ///< open, forward, lateral at full activation
  };
  std::vector<Lever> levers_;
};

/// Those of a rig (any struct with its field names): muscles with one end on the mandible and the other on a
/// fixed bone, each as the mean of its fibres.
template <class Rig>
JawMuscles jaw_muscles_of(const Rig& rig) {
  std::vector<JawMuscle> pulls;
  const auto& channels = rig.actuation.channels;
  for (uint32_t c = 0; c < channels.size(); ++c) {
    if (channels[c].muscle < 0) continue;
    const auto& muscle = rig.muscles[static_cast<size_t>(channels[c].muscle)];
    using End = std::decay_t<decltype(muscle.origin)>;
    const bool ends_there = muscle.insertion == End::mandible && muscle.origin == End::cranium;
    const bool begins_there = muscle.origin == End::mandible && muscle.insertion == End::cranium;
    if ((!ends_there && !begins_there) || muscle.fibre_offsets.size() < 2) continue;
    JawMuscle pull;
    pull.channel = c;
    pull.strength = static_cast<double>(muscle.strength);
    const double share = 1.0 / static_cast<double>(muscle.fibre_offsets.size() - 1);
    for (size_t f = 0; f + 1 < muscle.fibre_offsets.size(); ++f) {
      const uint32_t first = muscle.fibre_offsets[f], last = muscle.fibre_offsets[f + 1];
      if (last <= first) continue;
      pull.origin += share * muscle.points[ends_there ? first : last - 1].template cast<double>();
      pull.insertion += share * muscle.points[ends_there ? last - 1 : first].template cast<double>();
    }
    pulls.push_back(pull);
  }
  return JawMuscles(jaw_of(rig.skull.jaw), pulls);
}

}  // namespace fascia::sim
