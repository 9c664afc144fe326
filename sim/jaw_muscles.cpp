#include "sim/jaw_muscles.h"

#include <algorithm>
#include <cmath>

namespace fascia::sim {

JawMuscles::JawMuscles(const Jaw& jaw, std::span<const JawMuscle> muscles) {
  constexpr float step = 1e-3F;
  const RigidTransform by[3] = {jaw_transform(jaw, {step, 0, 0}), jaw_transform(jaw, {0, step, 0}),
                                jaw_transform(jaw, {0, 0, step})};
  Vec3 most = Vec3::Zero();  // of the pulls that each motion needs
  double right = 0.0;
  for (const JawMuscle& muscle : muscles) {
    const Vec3 along = muscle.origin - muscle.insertion;
    if (along.norm() < 1e-6 || !(muscle.strength > 0.0)) continue;
    const Vec3 pull = muscle.strength * along.normalized();
    Lever lever{muscle.channel, Vec3::Zero()};
    for (int k = 0; k < 3; ++k)
      lever.by[k] = pull.dot(by[k] * muscle.insertion - muscle.insertion) / static_cast<double>(step);
    most.x() += std::max(0.0, lever.by.x());
    most.y() += std::max(0.0, lever.by.y());
    most.z() += std::max(0.0, lever.by.z());
    right += std::max(0.0, -lever.by.z());
    levers_.push_back(lever);
  }
  most.z() = std::max(most.z(), right);
  for (Lever& lever : levers_)
    for (int k = 0; k < 3; ++k)
      lever.by[k] = most[k] > 0.0 ? lever.by[k] / most[k] : 0.0;
}

JawPose JawMuscles::moved(const JawPose& pose, std::span<const float> activations) const {
  Vec3 sum(pose.open, pose.forward, pose.lateral);
  for (const Lever& lever : levers_) {
    const float value = lever.channel < activations.size() ? activations[lever.channel] : 0.0F;
    if (std::isfinite(value) && value > 0.0F) sum += static_cast<double>(value) * lever.by;
  }
  return clamped({static_cast<float>(sum.x()), static_cast<float>(sum.y()), static_cast<float>(sum.z())});
}

}  // namespace fascia::sim
