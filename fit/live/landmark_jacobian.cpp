#include "fit/live/landmark_jacobian.h"

#include <algorithm>
#include <cmath>

#include "geometry/error.h"

namespace fascia::fit {

LandmarkJacobian::LandmarkJacobian(const sim::FaceModel& model, std::span<const Landmark> landmarks,
                                   std::span<const uint32_t> channels)
    : model_(&model),
      landmarks_(landmarks.begin(), landmarks.end()),
      channels_(channels.begin(), channels.end()),
      sensitivity_(model),
      nodes_(model.rest()) {
  if (!sensitivity_.linearise({}, nodes_))
    throw Error("the rig's stiffness matrix is singular (some tissue is unconstrained); build the rig again");
  making_.resize(static_cast<Eigen::Index>(3 * landmarks_.size()),
                 static_cast<Eigen::Index>(channels_.size()));
  gather(sensitivity_.columns(std::span(channels_).first(channels_.size() - 3)), 0);
  solve_jaw();
  at_rest_ = making_;
}

void LandmarkJacobian::forget() {
  stage_ = Stage::idle;
  std::fill(made_at_.begin(), made_at_.end(), 0.0F);
}

/// Takes columns of nodes, the first of which is that of the channel `first`, to rows of landmarks.
void LandmarkJacobian::gather(const Eigen::MatrixXd& columns, Eigen::Index first) {
  for (size_t l = 0; l < landmarks_.size(); ++l) {
    auto rows = making_.block(static_cast<Eigen::Index>(3 * l), first, 3, columns.cols());
    rows.setZero();
    for (const auto& [node, weight] : landmarks_[l].influences)
      rows += weight * columns.middleRows<3>(3 * static_cast<Eigen::Index>(node));
  }
}

void LandmarkJacobian::solve_jaw() {
  gather(sensitivity_.jaw_columns(), making_.cols() - 3);
  add_jaw_shares();
}

/// What hangs on the jaw itself, by small turns about where it stands.
void LandmarkJacobian::add_jaw_shares() {
  constexpr float much = 1e-2F;
  for (int motion = 0; motion < 3; ++motion) {
    const auto value = [motion](sim::JawPose& pose) -> float& {
      return motion == 0 ? pose.open : motion == 1 ? pose.forward : pose.lateral;
    };
    sim::JawPose low = jaw_, high = jaw_;
    value(low) -= much;
    value(high) += much;
    low = sim::clamped(low);
    high = sim::clamped(high);
    const double width = static_cast<double>(value(high)) - static_cast<double>(value(low));
    const sim::RigidTransform before = sim::jaw_transform(model_->jaw(), low),
                              after = sim::jaw_transform(model_->jaw(), high);
    for (size_t l = 0; l < landmarks_.size(); ++l)
      if (landmarks_[l].jaw_share != 0.0)
        making_.block<3, 1>(static_cast<Eigen::Index>(3 * l), making_.cols() - 3 + motion) +=
            landmarks_[l].jaw_share / width * (after * landmarks_[l].rest - before * landmarks_[l].rest);
  }
}

bool LandmarkJacobian::renew(const sim::Controls& controls, std::span<const sim::Vec3f> nodes,
                             Eigen::MatrixXd& jacobian) {
  constexpr float far = 0.05F;    // of a channel, from where the last one was made
  constexpr double share = 0.2;   // of the factor, a frame
  constexpr size_t at_once = 16;  // columns a frame
  const size_t tissue = channels_.size() - 3;
  if (stage_ == Stage::idle) {
    made_at_.resize(controls.activations.size(), 0.0F);
    float most = 0.0F;
    for (const uint32_t c : channels_)
      most = std::max(most, std::abs(controls.activations[c] - made_at_[c]));
    if (most < far) return false;
    for (size_t n = 0; n < nodes_.size(); ++n)
      nodes_[n] = nodes[n].cast<double>();
    std::copy(controls.activations.begin(), controls.activations.end(), made_at_.begin());
    jaw_ = controls.jaw;
    sensitivity_.begin(controls, nodes_);
    next_ = 0;
    stage_ = Stage::factoring;
  } else if (stage_ == Stage::factoring) {
    if (!sensitivity_.advance(share * sensitivity_.factor_work())) return false;
    stage_ = sensitivity_.is_sound() ? Stage::solving : Stage::idle;
  } else if (next_ < tissue) {
    const size_t count = std::min(at_once, tissue - next_);
    gather(sensitivity_.columns(std::span(channels_).subspan(next_, count)),
           static_cast<Eigen::Index>(next_));
    next_ += count;
  } else {
    solve_jaw();
    jacobian = making_;
    stage_ = Stage::idle;
    return true;
  }
  return false;
}

bool LandmarkJacobian::renew_whole(const sim::Controls& controls, std::span<const sim::Vec3f> nodes,
                                   Eigen::MatrixXd& jacobian) {
  do {
    if (renew(controls, nodes, jacobian)) return true;
  } while (stage_ != Stage::idle);
  return false;
}

}  // namespace fascia::fit
