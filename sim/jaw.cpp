#include "sim/jaw.h"

#include <algorithm>
#include <cmath>

#include "sim/formulas/motion.h"

namespace fascia::sim {

const char* jaw_fault(const Jaw& jaw) {
  constexpr double farthest_place = 1000.0, longest_glide = 10.0, largest_angle = 1.6, slack = 0.01;
  for (const Vec3* axis : {&jaw.lateral, &jaw.forward, &jaw.up})
    if (!(std::abs(axis->norm() - 1.0) < slack)) return "an axis of the jaw's joint is not of length 1";
  if (!(std::abs(jaw.lateral.dot(jaw.up)) < slack && std::abs(jaw.lateral.dot(jaw.forward)) < slack &&
        std::abs(jaw.forward.dot(jaw.up)) < slack))
    return "the axes of the jaw's joint are not square to one another";
  if (!(jaw.origin.cwiseAbs().array() <= farthest_place).all()) return "the jaw's joint is not near the head";
  if (!(std::abs(jaw.open_angle) <= largest_angle && std::abs(jaw.lateral_angle) <= largest_angle))
    return "the jaw turns by more than a right angle";
  if (!((jaw.open_glide.cwiseAbs().array() <= longest_glide).all() &&
        std::max({std::abs(jaw.forward_glide), std::abs(jaw.forward_drop), std::abs(jaw.lateral_glide)}) <=
            longest_glide))
    return "the jaw glides farther than any head is long";
  if (!(jaw.travel_time >= 0.0 && jaw.travel_time <= 10.0))
    return "the jaw takes longer than 10 s to open, or less than none";
  return nullptr;
}

JawPose clamped(const JawPose& pose) {
  const auto within = [](float value, float low) {
    return std::isfinite(value) ? std::clamp(value, low, 1.0F) : 0.0F;
  };
  return {within(pose.open, 0.0F), within(pose.forward, 0.0F), within(pose.lateral, -1.0F)};
}

JawPose approached(const JawPose& from, const JawPose& to, double seconds, double travel_time) {
  if (travel_time <= 0.0) return to;
  const auto most = static_cast<float>(std::max(0.0, seconds) / travel_time);
  const auto go = [most](float a, float b) { return a + std::clamp(b - a, -most, most); };
  return {go(from.open, to.open), go(from.forward, to.forward), go(from.lateral, to.lateral)};
}

RigidTransform jaw_transform(const Jaw& jaw, const JawPose& pose, double share) {
  RigidTransform result;
  if (pose.at_rest() || share == 0.0) return result;
  const double open = share * pose.open, forward = share * pose.forward, lateral = share * pose.lateral;
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 unit = Vec3::Unit(axis);
    result.rotation.col(axis) =
        unit + vec3(formulas::jaw_turn(three(jaw.lateral), three(jaw.up), open * jaw.open_angle,
                                       lateral * jaw.lateral_angle, three(unit)));
  }
  const Vec3 glide = (open * jaw.open_glide.x() + lateral * jaw.lateral_glide) * jaw.lateral +
                     (open * jaw.open_glide.y() - forward * jaw.forward_drop) * jaw.up +
                     (open * jaw.open_glide.z() + forward * jaw.forward_glide) * jaw.forward;
  result.translation = jaw.origin + glide - result.rotation * jaw.origin;
  return result;
}

}  // namespace fascia::sim
