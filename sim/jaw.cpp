#include "sim/jaw.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace fascia::sim {

JawPose clamped(const JawPose& pose) {
  const auto within = [](float value, float low) {
    return std::isfinite(value) ? std::clamp(value, low, 1.0F) : 0.0F;
  };
  return {within(pose.open, 0.0F), within(pose.forward, 0.0F), within(pose.lateral, -1.0F)};
}

JawPose approached(const JawPose& from, const JawPose& to, double seconds) {
  const auto most = static_cast<float>(std::max(0.0, seconds) / quickest_travel);
  const auto go = [most](float a, float b) { return a + std::clamp(b - a, -most, most); };
  return {go(from.open, to.open), go(from.forward, to.forward), go(from.lateral, to.lateral)};
}

RigidTransform jaw_transform(const Jaw& jaw, const JawPose& pose, double share) {
  RigidTransform result;
  if (pose.at_rest() || share == 0.0) return result;
  const double open = share * pose.open, forward = share * pose.forward, lateral = share * pose.lateral;
  result.rotation = (Eigen::AngleAxisd(lateral * jaw.lateral_angle, jaw.up) *
                     Eigen::AngleAxisd(open * jaw.open_angle, jaw.lateral))
                        .toRotationMatrix();
  const Vec3 glide = (open * jaw.open_glide.x() + lateral * jaw.lateral_glide) * jaw.lateral +
                     (open * jaw.open_glide.y() - forward * jaw.forward_drop) * jaw.up +
                     (open * jaw.open_glide.z() + forward * jaw.forward_glide) * jaw.forward;
  result.translation = jaw.origin + glide - result.rotation * jaw.origin;
  return result;
}

}  // namespace fascia::sim
