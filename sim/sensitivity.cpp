#include "sim/sensitivity.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "sim/formulas/activation_force.h"
#include "sim/formulas/elements.h"

namespace fascia::sim {
namespace {

using Triplets = std::vector<Eigen::Triplet<double>>;

/// Collects 3 x 3 blocks between nodes into the rows and columns of unknowns, lower half.
struct Blocks {
  const std::vector<int32_t>& unknown;
  Triplets& list;
  void add(uint32_t row, uint32_t column, const Mat3& block) {
    const int32_t r = unknown[row], c = unknown[column];
    if (r < 0 || c < 0 || r < c) return;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        if (3 * r + i >= 3 * c + j) list.emplace_back(3 * r + i, 3 * c + j, block(i, j));
  }
};

template <size_t Count>
void add_stencils(const std::vector<Curvature::Stencil<Count>>& stencils, Blocks& blocks) {
  for (const auto& s : stencils)
    for (size_t i = 0; i < Count; ++i)
      for (size_t j = 0; j < Count; ++j)
        blocks.add(s.nodes[i], s.nodes[j], s.weights[i] * s.weights[j] * s.block);
}

void add_plates(const std::vector<Curvature::Plate>& plates, Blocks& blocks) {
  for (const auto& p : plates) {
    // The deformation gradient's columns are blends of the three nodes.
    Eigen::Matrix<double, 3, 2> blend;
    blend.row(1) = p.inverse_rest.row(0);
    blend.row(2) = p.inverse_rest.row(1);
    blend.row(0) = -blend.row(1) - blend.row(2);
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) {
        Mat3 block = Mat3::Zero();
        for (int i = 0; i < 2; ++i)
          for (int j = 0; j < 2; ++j)
            block += blend(a, i) * blend(b, j) * p.block.block<3, 3>(3 * i, 3 * j);
        blocks.add(p.nodes[static_cast<size_t>(a)], p.nodes[static_cast<size_t>(b)], block);
      }
  }
}

/// What a fibre's pull must add to the stiffness along itself to count: a share of what is there without it.
constexpr float least_pull = 0.03F;

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
      unknown_of_node_(model.rest().size(), -1),
      work_(3 * model.rest().size()),
      direction_(model.rest().size(), Vec3::Zero()),
      product_(model.rest().size()) {
  for (size_t i = 0; i < model.unknowns().size(); ++i)
    unknown_of_node_[model.unknowns()[i]] = static_cast<int32_t>(i);
  for (const uint32_t node : model.unknowns())
    unknown_places_.push_back(model.rest()[node]);
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
  begin(controls, x);
  advance(std::numeric_limits<double>::infinity());
  return is_sound();
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
  model_->find_curvature(frame_, pose_.data(), curvature_);
  gather_pulls();
  factor_.forget();
  is_held_up_ = is_assembled_ = false;
}

bool Sensitivity::advance(double work) {
  if (!is_assembled_) {
    assemble(1e-6);  // a touch of the rest stiffness keeps what nothing holds
    is_assembled_ = true;
    if (std::isfinite(work)) return false;
  }
  if (!factor_.is_sound()) {
    if (!factor_.advance(work)) return false;
    if (!factor_.is_sound()) {
      if (is_held_up_) return true;
      is_held_up_ = true;
      assemble(1e-3);
      return advance(work);
    }
    if (std::isfinite(work)) return false;  // pulls are for another time
  }
  return solve_pulls(work);
}

/// Some columns of what the factor makes of the pulls; true when there are no more.
bool Sensitivity::solve_pulls(double work) {
  if (pulls_.cols() == 0) return true;
  const double a_column = static_cast<double>(factor_.entries());
  const Eigen::Index left = pulls_.cols() - pulls_done_,
                     count = work < a_column * static_cast<double>(left)
                                 ? std::max<Eigen::Index>(1, static_cast<Eigen::Index>(work / a_column))
                                 : left;
  const FrontFactor::Dense halfway =
      factor_.forward(Eigen::MatrixXd(pulls_.middleCols(pulls_done_, count)).cast<float>());
  for (Eigen::Index row = 0; row < count; ++row)
    if (halfway.row(row).squaredNorm() > least_pull) halfway_pulls_.row(pulls_kept_++) = halfway.row(row);
  pulls_done_ += count;
  if (pulls_done_ < pulls_.cols()) return false;
  FrontFactor::Dense small = FrontFactor::Dense::Identity(pulls_kept_, pulls_kept_);
  small.selfadjointView<Eigen::Lower>().rankUpdate(halfway_pulls_.topRows(pulls_kept_));
  pull_factor_.compute(small);
  return true;
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
        direction_[i] = unknown_of_node_[i] < 0 ? frame_.carried[i] : pose_[i];
      model_->energy(frame_, direction_.data(), product_.data());
      const double sign = end == 0 ? -1.0 : 1.0;
      for (size_t i = 0; i < nodes; ++i) {
        if (unknown_of_node_[i] < 0)
          jaw_carried_.col(motion).segment<3>(static_cast<Eigen::Index>(3 * i)) += sign * direction_[i];
        else
          jaw_forces_.col(motion).segment<3>(3 * unknown_of_node_[i]) += sign * product_[i];
      }
    }
    const double width = ends[1] - ends[0];
    jaw_forces_.col(motion) *= width > 0.0 ? 1.0 / width : 0.0;
    jaw_carried_.col(motion) *= width > 0.0 ? 1.0 / width : 0.0;
  }
}

/// The curvature but for fibres' pulls, with a share `held` of the rest stiffness on its diagonal.
void Sensitivity::assemble(double held) {
  Triplets& list = entries_;
  list.clear();
  Blocks blocks{unknown_of_node_, list};
  add_stencils(curvature_.points, blocks);
  add_stencils(curvature_.pairs, blocks);
  add_stencils(curvature_.quads, blocks);
  add_stencils(curvature_.sixes, blocks);
  add_plates(curvature_.plates, blocks);
  for (const auto& b : curvature_.bends)
    for (size_t i = 0; i < 4; ++i)
      for (size_t j = 0; j < 4; ++j)
        blocks.add(b.nodes[i], b.nodes[j], b.stiffness * b.slopes[i].transpose() * b.slopes[j]);
  for (const auto& v : curvature_.volumes)
    for (size_t i = 0; i < 6; ++i)
      for (size_t j = 0; j < 6; ++j)
        blocks.add(v.nodes[i], v.nodes[j], v.stiffness * v.slopes[i] * v.slopes[j].transpose());
  const auto size = static_cast<Eigen::Index>(3 * model_->unknowns().size());
  const auto& rest = model_->stiffness();
  for (Eigen::Index i = 0; i < size; ++i)
    list.emplace_back(i, i, held * rest.coeff(i / 3, i / 3));
  Eigen::SparseMatrix<double> matrix(size, size);
  matrix.setFromTriplets(list.begin(), list.end());
  factor_.begin(matrix, unknown_places_);
}

void Sensitivity::gather_pulls() {
  const auto size = static_cast<Eigen::Index>(3 * model_->unknowns().size());
  Triplets list;
  for (size_t p = 0; p < curvature_.pulls.size(); ++p) {
    const auto& pull = curvature_.pulls[p];
    for (size_t i = pull.first; i < pull.first + pull.count; ++i) {
      const int32_t unknown = unknown_of_node_[curvature_.pull_nodes[i]];
      const Vec3 slope = std::sqrt(pull.stiffness) * curvature_.pull_slopes[i];
      for (int k = 0; unknown >= 0 && k < 3; ++k)
        list.emplace_back(3 * unknown + k, static_cast<int>(p), slope[k]);
    }
  }
  pulls_.resize(size, static_cast<Eigen::Index>(curvature_.pulls.size()));
  pulls_.setFromTriplets(list.begin(), list.end());
  halfway_pulls_.resize(pulls_.cols(), size);
  pulls_done_ = pulls_kept_ = 0;
}

Eigen::MatrixXd Sensitivity::solve(const Eigen::MatrixXd& right) const {
  FrontFactor::Dense halfway = factor_.forward(right.cast<float>());
  if (pulls_kept_ > 0) {
    const auto pulls = halfway_pulls_.topRows(pulls_kept_);
    halfway.noalias() -= pull_factor_.solve(pulls * halfway.transpose()).transpose() * pulls;
  }
  return factor_.backward(halfway).cast<double>();
}

Eigen::MatrixXd Sensitivity::columns(std::span<const uint32_t> channels) const {
  const auto count = static_cast<Eigen::Index>(channels.size());
  Eigen::MatrixXd right = Eigen::MatrixXd::Zero(jaw_forces_.rows(), count);
  for (Eigen::Index c = 0; c < count; ++c)
    if (const uint32_t channel = channels[static_cast<size_t>(c)]; channel < forces_.size())
      for (const Force& force : forces_[channel])
        if (unknown_of_node_[force.node] >= 0)
          right.col(c).segment<3>(3 * unknown_of_node_[force.node]) -= force.slope;
  const Eigen::MatrixXd solution = solve(right);
  Eigen::MatrixXd all = Eigen::MatrixXd::Zero(static_cast<Eigen::Index>(3 * pose_.size()), count);
  for (size_t u = 0; u < model_->unknowns().size(); ++u)
    all.middleRows<3>(static_cast<Eigen::Index>(3 * model_->unknowns()[u])) =
        solution.middleRows<3>(static_cast<Eigen::Index>(3 * u));
  return all;
}

Eigen::MatrixXd Sensitivity::jaw_columns() const {
  const Eigen::MatrixXd solution = solve(-jaw_forces_);
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
    if (unknown_of_node_[i] < 0) direction_[i].setZero();
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
        if (unknown_of_node_[force.node] >= 0)
          result[c] -= lambda.segment<3>(3 * unknown_of_node_[force.node]).dot(force.slope);
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
