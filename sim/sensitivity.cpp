#include "sim/sensitivity.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "sim/formulas/activation_force.h"
#include "sim/formulas/elements.h"

namespace fascia::sim {
namespace {

bool is_held(uint8_t anchor) {
  const auto kind = static_cast<FibreAnchor>(anchor);
  return kind == FibreAnchor::cranium || kind == FibreAnchor::mandible;
}

JawPose moved(const JawPose& pose, int motion, float by) {
  JawPose result = pose;
  (motion == 0 ? result.open : motion == 1 ? result.forward : result.lateral) += by;
  return clamped(result);
}

float value_of(const JawPose& pose, int motion) {
  return motion == 0 ? pose.open : motion == 1 ? pose.forward : pose.lateral;
}

}  // namespace

Sensitivity::Sensitivity(const FaceModel& model)
    : model_(&model),
      frame_(model.make_frame()),
      pose_(model.rest()),
      hessian_(model),
      work_(3 * model.rest().size()),
      direction_(model.rest().size(), Vec3::Zero()),
      product_(model.rest().size()) {
  const Lattice& lattice = model.lattice();
  uint32_t channels = 0;
  for (const auto list : {lattice.fibre_channel, lattice.carrier_channel, lattice.pressure_channel})
    for (const uint32_t channel : list)
      channels = std::max(channels, channel + 1);
  forces_.resize(channels);
}

bool Sensitivity::linearise(const Controls& controls, std::span<const Vec3> x, bool keeps_factor) {
  if (keeps_factor) {
    find_slopes(controls, x);
    return true;
  }
  find_slopes(controls, x);
  return hessian_.compute(frame_, pose_.data());
}

void Sensitivity::find_slopes(const Controls& controls, std::span<const Vec3> x) {
  pose_.assign(x.begin(), x.end());
  find_jaw_forces(controls);
  model_->place(controls, frame_);
  model_->find_facing(pose_.data(), frame_);
  find_forces(controls);
}

void Sensitivity::begin(const Controls& controls, std::span<const Vec3> x) {
  find_slopes(controls, x);
  hessian_.begin(frame_, pose_.data());
}

/// d gradient / d activation by channel: pressures are linear in theirs, fibres in their pull, carriers turn.
void Sensitivity::find_forces(const Controls& controls) {
  for (auto& list : forces_)
    list.clear();
  const Lattice& lattice = model_->lattice();
  const auto point = [&](uint32_t p) {
    Vec3 place = frame_.fibre_anchors[p];
    for (size_t k = 0; k < 3 && !is_held(lattice.fibre_anchor[p]); ++k) {
      const uint32_t node = lattice.fibre_nodes[p][k];
      place += static_cast<double>(lattice.fibre_weights[p][static_cast<int>(k)]) *
               (pose_[node] - model_->rest()[node]);
    }
    return place;
  };
  for (uint32_t f = 0; f < lattice.fibre_count(); ++f) {
    const uint32_t first = lattice.fibre_offsets[f], last = lattice.fibre_offsets[f + 1];
    double length = 0.0, energy = 0.0;
    for (uint32_t p = first; p + 1 < last; ++p)
      length += lattice.fibre_taper[p] * formulas::segment_length(three(point(p + 1) - point(p)));
    const double rest_length = model_->fibre_lengths()[f];
    if (rest_length <= 0.0) continue;
    const double value = std::max(0.0F, controls.activation(lattice.fibre_channel[f]));
    const double pull = formulas::activation_force_slope(value, model_->options().initial_force_slope) *
                        static_cast<double>(lattice.fibre_strength[f]);
    const double tension = formulas::fibre_tension(pull, length, rest_length,
                                                   static_cast<double>(lattice.fibre_shortest[f]), energy);
    for (uint32_t p = first; p + 1 < last; ++p) {
      const Vec3 along = point(p + 1) - point(p);
      const Vec3 force = (tension * lattice.fibre_taper[p] / formulas::segment_length(three(along))) * along;
      for (const uint32_t end : {p, p + 1})
        for (size_t k = 0; k < 3 && !is_held(lattice.fibre_anchor[end]); ++k)
          forces_[lattice.fibre_channel[f]].push_back(
              {lattice.fibre_nodes[end][k],
               (end == p ? -1.0 : 1.0) *
                   static_cast<double>(lattice.fibre_weights[end][static_cast<int>(k)]) * force});
    }
  }
  for (size_t p = 0; p < lattice.pressure_prism.size(); ++p) {
    std::array<Vec3, 6> corners;
    std::array<uint32_t, 3> nodes{};
    for (size_t k = 0; k < 3; ++k) {
      nodes[k] = lattice.columns + lattice.triangles[lattice.pressure_prism[p]][k];
      corners[k] = pose_[nodes[k]];
      corners[k + 3] = frame_.carried[nodes[k]];
    }
    const auto push = prism_volume_gradient({0, 1, 2, 3, 4, 5}, corners.data());
    for (size_t k = 0; k < 3; ++k)
      forces_[lattice.pressure_channel[p]].push_back(
          {nodes[k], -static_cast<double>(lattice.pressure[p]) * push[k]});
  }
  if (lattice.carrier_node.empty()) return;
  // Carriers listen to one channel each, so all are moved at once; not across the bend at 0.
  const float step = 1e-3F;
  std::vector<float> low(forces_.size()), high(forces_.size());
  for (uint32_t c = 0; c < low.size(); ++c) {
    const float value = controls.activation(c);
    low[c] = value >= 0.0F ? std::max(0.0F, value - step) : value - step;
    high[c] = value < 0.0F ? std::min(0.0F, value + step) : value + step;
  }
  Controls ends = controls;
  ends.activations = low;
  model_->place(ends, frame_);
  const Positions before = frame_.carrier_pulls;
  ends.activations = high;
  model_->place(ends, frame_);
  for (size_t c = 0; c < lattice.carrier_node.size(); ++c) {
    const uint32_t channel = lattice.carrier_channel[c];
    const double width = static_cast<double>(high[channel]) - static_cast<double>(low[channel]);
    forces_[channel].push_back({lattice.carrier_node[c], (before[c] - frame_.carrier_pulls[c]) / width});
  }
  model_->place(controls, frame_);
}

/// The jaw moves bones, anchors and prescribed nodes all at once: differences of the gradient at free nodes'
/// fixed places.
void Sensitivity::find_jaw_forces(const Controls& controls) {
  const size_t nodes = pose_.size();
  jaw_forces_.setZero(static_cast<Eigen::Index>(3 * model_->unknowns().size()), 3);
  jaw_carried_.setZero(static_cast<Eigen::Index>(3 * nodes), 3);
  for (int motion = 0; motion < 3; ++motion) {
    double ends[2] = {0.0, 0.0};
    for (int end = 0; end < 2; ++end) {
      Controls other = controls;
      other.jaw = moved(controls.jaw, motion, end == 0 ? -1e-3F : 1e-3F);
      ends[end] = static_cast<double>(value_of(other.jaw, motion));
      model_->place(other, frame_);
      if (end == 0) model_->find_facing(pose_.data(), frame_);
      for (size_t i = 0; i < nodes; ++i)
        direction_[i] = hessian_.unknown_of_node()[i] < 0 ? frame_.carried[i] : pose_[i];
      model_->energy(frame_, direction_.data(), product_.data());
      const double sign = end == 0 ? -1.0 : 1.0;
      for (size_t i = 0; i < nodes; ++i) {
        if (hessian_.unknown_of_node()[i] < 0)
          jaw_carried_.col(motion).segment<3>(static_cast<Eigen::Index>(3 * i)) += sign * direction_[i];
        else
          jaw_forces_.col(motion).segment<3>(3 * hessian_.unknown_of_node()[i]) += sign * product_[i];
      }
    }
    const double width = ends[1] - ends[0];
    jaw_forces_.col(motion) *= width > 0.0 ? 1.0 / width : 0.0;
    jaw_carried_.col(motion) *= width > 0.0 ? 1.0 / width : 0.0;
  }
}

Eigen::VectorXd Sensitivity::solve(const Eigen::VectorXd& right) const {
  return hessian_.solve(right.cast<float>()).cast<double>();
}

Eigen::MatrixXd Sensitivity::columns(std::span<const uint32_t> channels) const {
  const auto count = static_cast<Eigen::Index>(channels.size());
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(jaw_forces_.rows(), count);
  for (Eigen::Index c = 0; c < count; ++c)
    if (const uint32_t channel = channels[static_cast<size_t>(c)]; channel < forces_.size())
      for (const Force& force : forces_[channel])
        if (hessian_.unknown_of_node()[force.node] >= 0)
          right.col(c).segment<3>(3 * hessian_.unknown_of_node()[force.node]) -= force.slope;
  const Eigen::MatrixXd solution = hessian_.solve(right.cast<float>()).cast<double>();
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(3 * pose_.size()), count);
  for (size_t u = 0; u < model_->unknowns().size(); ++u)
    all.middleRows<3>(static_cast<Eigen::Index>(3 * model_->unknowns()[u])) =
        solution.middleRows<3>(static_cast<Eigen::Index>(3 * u));
  return all;
}

Eigen::MatrixXd Sensitivity::jaw_columns() const {
  const Eigen::MatrixXd solution = hessian_.solve(-jaw_forces_.cast<float>()).cast<double>();
  Eigen::MatrixXd all = jaw_carried_;
  for (size_t u = 0; u < model_->unknowns().size(); ++u)
    all.middleRows<3>(static_cast<Eigen::Index>(3 * model_->unknowns()[u])) =
        solution.middleRows<3>(static_cast<Eigen::Index>(3 * u));
  return all;
}

Eigen::VectorXd Sensitivity::hessian_times(const Eigen::VectorXd& direction) const {
  for (size_t u = 0; u < model_->unknowns().size(); ++u)
    direction_[model_->unknowns()[u]] = direction.segment<3>(static_cast<Eigen::Index>(3 * u));
  for (size_t i = 0; i < direction_.size(); ++i)
    if (hessian_.unknown_of_node()[i] < 0) direction_[i].setZero();
  model_->hessian_times(frame_, pose_.data(), direction_.data(), product_.data(), work_);
  Eigen::VectorXd result(direction.size());
  for (size_t u = 0; u < model_->unknowns().size(); ++u)
    result.segment<3>(static_cast<Eigen::Index>(3 * u)) = product_[model_->unknowns()[u]];
  return result;
}

Eigen::VectorXd Sensitivity::adjoint(const Eigen::VectorXd& slope, std::span<const uint32_t> channels) const {
  constexpr int iterations = 40;
  constexpr double tolerance = 1e-3;
  Eigen::VectorXd residual(jaw_forces_.rows());
  for (size_t u = 0; u < model_->unknowns().size(); ++u)
    residual.segment<3>(static_cast<Eigen::Index>(3 * u)) =
        slope.segment<3>(static_cast<Eigen::Index>(3 * model_->unknowns()[u]));
  // Conjugate gradients on the exact Hessian, the stand-in's factor as preconditioner.
  Eigen::VectorXd lambda = Eigen::VectorXd::Zero(residual.size()), packed = solve(residual),
                  direction = packed;
  double energy = packed.dot(residual);
  const double enough = tolerance * tolerance * energy;
  for (int i = 0; i < iterations && energy > enough && energy > 0.0; ++i) {
    const Eigen::VectorXd product = hessian_times(direction);
    const double curvature = direction.dot(product);
    if (!(curvature > 0.0)) {  // the Hessian is not positive here: the stand-in's own answer
      if (i == 0) lambda = packed;
      break;
    }
    lambda += (energy / curvature) * direction;
    residual -= (energy / curvature) * product;
    packed = solve(residual);
    const double next = packed.dot(residual);
    direction = packed + (next / energy) * direction;
    energy = next;
  }
  const auto count = static_cast<Eigen::Index>(channels.size());
  Eigen::VectorXd result = Eigen::VectorXd::Zero(count + 3);
  for (Eigen::Index c = 0; c < count; ++c)
    if (const uint32_t channel = channels[static_cast<size_t>(c)]; channel < forces_.size())
      for (const Force& force : forces_[channel])
        if (hessian_.unknown_of_node()[force.node] >= 0)
          result[c] -= lambda.segment<3>(3 * hessian_.unknown_of_node()[force.node]).dot(force.slope);
  result.tail<3>() = jaw_carried_.transpose() * slope - jaw_forces_.transpose() * lambda;
  return result;
}

bool Sensitivity::listens(uint32_t channel) const {
  const Lattice& lattice = model_->lattice();
  for (const auto list : {lattice.fibre_channel, lattice.carrier_channel, lattice.pressure_channel})
    if (std::find(list.begin(), list.end(), channel) != list.end()) return true;
  return false;
}

}  // namespace fascia::sim
