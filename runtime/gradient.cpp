#include "runtime/gradient.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace fascia::runtime {
namespace {

/// d transform / d value as a linear map of places.
struct Motion {
  Eigen::Matrix3d turn = Eigen::Matrix3d::Zero();
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();
};

/// How the jaw's transform changes with one of its values, by central differences of the closed form.
Motion jaw_motion(const sim::Jaw& jaw, const sim::JawPose& pose, int value) {
  constexpr float step = 1e-3F;
  sim::JawPose low = pose, high = pose;
  const auto of = [value](sim::JawPose& at) -> float& {
    return value == 0 ? at.open : value == 1 ? at.forward : at.lateral;
  };
  of(low) -= step;
  of(high) += step;
  const double width = static_cast<double>(of(high)) - static_cast<double>(of(low));
  const sim::RigidTransform a = jaw_transform(jaw, low), b = jaw_transform(jaw, high);
  return {(b.rotation - a.rotation) / width, (b.translation - a.translation) / width};
}

/// How an eye's rotation changes with yaw (0) or pitch (1).
Eigen::Matrix3d eye_motion(float yaw, float pitch, int value) {
  constexpr float step = 1e-2F;
  const auto at = [&](float by) -> Eigen::Matrix3d {
    return eye_rotation(yaw + (value == 0 ? by : 0.0F), pitch + (value == 1 ? by : 0.0F)).cast<double>();
  };
  return (at(step) - at(-step)) / (2.0 * static_cast<double>(step));
}

/// The loss's derivatives by what moves vertices.
struct Slopes {
  Eigen::VectorXd nodes;
  Eigen::Vector3d jaw = Eigen::Vector3d::Zero();
  double eyes[2][2] = {};  ///< by eye, yaw and pitch
};

Slopes slopes_of(Face& face, std::span<const float* const> slopes) {
  Slopes sum;
  sum.nodes = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(3 * face.model().rest().size()));
  const BoneChannels& channels = face.asset().bones();
  Motion jaw[3];
  for (int k = 0; k < 3; ++k)
    jaw[k] = jaw_motion(face.model().jaw(), face.shown_jaw(), k);
  Eigen::Matrix3d eyes[2][2];
  for (std::size_t eye = 0; eye < 2; ++eye)
    for (int k = 0; k < 2; ++k)
      eyes[eye][k] = eye_motion(face.mixer().effective(channels.eye_yaw[eye]),
                                face.mixer().effective(channels.eye_pitch[eye]), k);
  for (std::size_t mesh = 0; mesh < slopes.size(); ++mesh) {
    if (slopes[mesh] == nullptr) continue;
    const MeshShape& shape = face.shape(mesh);
    const Eigen::Matrix3d to_metres = shape.from_metres().cast<double>().transpose();
    for (const MeshShape::Follower& follower : shape.followers()) {
      const Vec3f slope = Eigen::Map<const Vec3f>(slopes[mesh] + 3 * std::size_t{follower.vertex});
      require(slope.allFinite(), "a slope is not a finite number");
      const Eigen::Vector3d pull = to_metres * slope.cast<double>();
      const Eigen::Vector3d rest = shape.rest_metres(follower.vertex).cast<double>();
      if (follower.eye != 0) {
        const std::size_t eye = follower.eye - 1U;
        const Eigen::Vector3d arm = rest - face.bones().eye_centres[eye].cast<double>();
        for (int k = 0; k < 2; ++k)
          sum.eyes[eye][k] += pull.dot(eyes[eye][k] * arm);
        continue;
      }
      for (uint32_t i = follower.first; i < follower.end; ++i)
        sum.nodes.segment<3>(3 * static_cast<Eigen::Index>(shape.nodes()[i])) +=
            static_cast<double>(shape.weights()[i]) * pull;
      for (int k = 0; k < 3; ++k)
        sum.jaw[k] += static_cast<double>(follower.jaw_share) * pull.dot(jaw[k].turn * rest + jaw[k].shift);
    }
  }
  return sum;
}

Eigen::Vector3d numbers(const sim::JawPose& pose) {
  return {static_cast<double>(pose.open), static_cast<double>(pose.forward),
          static_cast<double>(pose.lateral)};
}

}  // namespace

void find_gradient(Face& face, std::span<const float* const> slopes, std::span<float> by_channel) {
  const Slopes loss = slopes_of(face, slopes);
  std::vector<uint32_t> all(by_channel.size());
  for (uint32_t c = 0; c < all.size(); ++c)
    all[c] = c;
  const Eigen::VectorXd adjoint = face.sensitivity().adjoint(loss.nodes, all);
  const Eigen::Vector3d by_jaw = adjoint.tail<3>() + loss.jaw;
  std::vector<float> values = face.mixer().effective();
  const Asset& asset = face.asset();
  for (std::size_t c = 0; c < by_channel.size(); ++c) {
    // Where the jaw goes is linear in the channels but for the ends of its range.
    constexpr float step = 1e-2F;
    const float value = values[c];
    const float low = std::max(value - step, std::min(value, asset.channel_minimum[c])),
                high = std::min(value + step, std::max(value, asset.channel_maximum[c]));
    double by_value = adjoint[static_cast<Eigen::Index>(c)];
    if (high > low) {
      values[c] = high;
      const Eigen::Vector3d above = numbers(face.wanted_jaw(values));
      values[c] = low;
      const Eigen::Vector3d below = numbers(face.wanted_jaw(values));
      values[c] = value;
      by_value += by_jaw.dot(above - below) / (static_cast<double>(high) - static_cast<double>(low));
    }
    by_channel[c] = static_cast<float>(by_value);
  }
  for (std::size_t eye = 0; eye < 2; ++eye) {
    const int32_t channels[2] = {asset.bones().eye_yaw[eye], asset.bones().eye_pitch[eye]};
    for (int k = 0; k < 2; ++k)
      if (channels[k] >= 0)
        by_channel[static_cast<std::size_t>(channels[k])] += static_cast<float>(loss.eyes[eye][k]);
  }
}

}  // namespace fascia::runtime
