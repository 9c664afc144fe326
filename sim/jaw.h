#pragma once

#include "sim/vector.h"

namespace fascia::sim {

/// x -> rotation * x + translation.
struct RigidTransform {
  Mat3 rotation = Mat3::Identity();
  Vec3 translation = Vec3::Zero();
  Vec3 operator*(const Vec3& point) const { return rotation * point + translation; }
};

/// The temporomandibular joint in closed form: a hinge through both condyles that rotates and translates.
/// Metres and radians; `lateral`, `up`, `forward` are unit axes, lateral to the subject's left. By default it
/// does not move.
struct Jaw {
  Vec3 origin = Vec3::Zero();
  Vec3 lateral = Vec3::UnitX(), forward = Vec3::UnitZ(), up = Vec3::UnitY();
  double open_angle = 0.0;         ///< radians of rotation at open = 1
  Vec3 open_glide = Vec3::Zero();  ///< (lateral, up, forward) at open = 1
  double forward_glide = 0.0;      ///< at forward = 1
  double forward_drop = 0.0;       ///< downward at forward = 1
  double lateral_angle = 0.0;      ///< radians about `up` at lateral = 1
  double lateral_glide = 0.0;      ///< to the subject's left at lateral = 1
  double travel_time = 0.0;        ///< seconds: shortest, from 0 to 1 of a channel
};

/// Values of the jaw's channels: `open` and `forward` in 0..1, `lateral` in -1..1 (+ to the left).
struct JawPose {
  float open = 0.0F, forward = 0.0F, lateral = 0.0F;
  bool at_rest() const { return open == 0.0F && forward == 0.0F && lateral == 0.0F; }
  bool operator==(const JawPose&) const = default;
};

/// A message if `jaw` is invalid, or null: axes that are not orthonormal, numbers that are not finite or
/// implausible.
const char* jaw_fault(const Jaw& jaw);

/// `pose` within the joint's limits; values that are not finite become 0.
JawPose clamped(const JawPose& pose);

/// The pose reached from `from` toward `to` within some seconds: no component goes from 0 to 1 in less than
/// `travel_time` seconds (of the joint), so that a step change of a channel does not tear the tissue. Both
/// within the joint's limits.
JawPose approached(const JawPose& from, const JawPose& to, double seconds, double travel_time);

/// The motion of a point by the fraction `share` (0..1) of the pose. At 1 this is the mandible's motion; in
/// between, tissue between both bones rotates by a fraction of the angle, which preserves lengths, unlike a
/// blend of positions. Exactly the identity at rest or share 0.
RigidTransform jaw_transform(const Jaw& jaw, const JawPose& pose, double share = 1.0);

/// The joint of a rig (any struct with its field names).
template <class Joint>
Jaw jaw_of(const Joint& joint) {
  Jaw jaw;
  jaw.origin = joint.origin.template cast<double>();
  jaw.lateral = joint.lateral.template cast<double>();
  jaw.forward = joint.forward.template cast<double>();
  jaw.up = joint.up.template cast<double>();
  jaw.open_angle = joint.open_angle;
  jaw.open_glide = joint.open_glide.template cast<double>();
  jaw.forward_glide = joint.forward_glide;
  jaw.forward_drop = joint.forward_drop;
  jaw.lateral_angle = joint.lateral_angle;
  jaw.lateral_glide = joint.lateral_glide;
  jaw.travel_time = joint.travel_time;
  return jaw;
}

}  // namespace fascia::sim
