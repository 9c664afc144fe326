#include "fit/fit.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "fit/live/dearness.h"
#include "geometry/alignment.h"
#include "geometry/dense.h"
#include "geometry/error.h"

namespace fascia::fit {
namespace {

constexpr double square_mm = 1e6;        // of a square metre
constexpr double along_surface = 0.003;  // what a vertex that may slide costs along the surface, of across it
constexpr double unseen_gaze = 50.0;  // cost of turning an eye that only its lids tell of, of a common muscle

using RowsByAxis = Eigen::Map<const Eigen::MatrixXd, 0, Eigen::Stride<Eigen::Dynamic, 3>>;

/// Rows `axis`, `axis` + 3, ... of a matrix of stacked 3-vectors.
RowsByAxis axis_rows(const Eigen::MatrixXd& matrix, int axis) {
  return RowsByAxis(matrix.data() + axis, matrix.rows() / 3, matrix.cols(),
                    Eigen::Stride<Eigen::Dynamic, 3>(matrix.rows(), 3));
}

}  // namespace

Fitter::Fitter(Subject& subject, const FitOptions& options)
    : subject_(&subject),
      sensitivity_(subject.model()),
      dearness_(dearness_of(subject.file().rig.actuation)) {
  for (uint32_t c = 0; c < subject.channels().size(); ++c)
    if (subject.channels()[c].group != "jaw" && sensitivity_.listens(c)) {
      driven_.push_back(c);
      if (is_eye(c)) dearness_[c] = unseen_gaze;
    }
  fitted_ = driven_;
  for (const char* name : {"jaw_open", "jaw_forward", "jaw_lateral"}) {
    const int32_t at = subject.channel(name);
    if (at < 0) throw Error(std::string("the rig has no channel '") + name + "': build it again");
    fitted_.push_back(static_cast<uint32_t>(at));
  }
  set_options(options);
}

void Fitter::set_options(const FitOptions& options) {
  options_ = options;
  hold(std::array<bool, 2>{false, false});
}

bool Fitter::is_eye(uint32_t channel) const {
  return subject_->channels()[channel].group == "eye";
}

void Fitter::hold(const std::array<bool, 2>& eyes) {
  is_held_.assign(subject_->channels().size(), false);
  for (const uint32_t channel : options_.held)
    is_held_.at(channel) = true;
  for (const uint32_t channel : driven_)
    if (is_eye(channel) && eyes[subject_->channels()[channel].name.ends_with("_left") ? 0 : 1])
      is_held_[channel] = true;
}

FitResult Fitter::fit(const Target& target) {
  is_sequence_ = false;
  return solve(target, false);
}

FitResult Fitter::follow(const Target& target) {
  const bool is_next = is_sequence_;
  is_sequence_ = true;
  return solve(target, is_next);
}

double Fitter::price(double of_common, size_t i) const {
  return of_common * dearness_[fitted_[i]] * visibility_.share(static_cast<Eigen::Index>(i));
}

double Fitter::price_of_change(size_t i) const {
  if (last_.empty()) return 0.0;
  const double to_hold = std::max(options_.smoothness, FitOptions().smoothness);
  return options_.smoothness + to_hold * visibility_.hold(static_cast<Eigen::Index>(i));
}

double Fitter::cost(const std::vector<float>& values) const {
  double sum = 0.0;
  for (size_t i = 0; i < fitted_.size(); ++i) {
    const uint32_t c = fitted_[i];
    const double value = values[c];
    sum += price(options_.ridge, i) * value * value + price(options_.sparsity, i) * std::abs(value);
    if (!last_.empty()) sum += price_of_change(i) * std::pow(value - static_cast<double>(last_[c]), 2);
  }
  return sum;
}

double Fitter::objective(const Target& target, const std::vector<float>& values, bool warm,
                         Eigen::VectorXd& difference) {
  subject_->pose(values, warm);
  difference = subject_->displacements(values) - target.displacements;
  double sum = 0.0;
  for (Eigen::Index v = 0; v < vertex_weights_.size(); ++v)
    if (vertex_weights_[v] > 0.0) {
      const Vec3 gap = difference.segment<3>(3 * v);
      sum += gap.dot(weighted(v, gap));
    }
  return square_mm * sum + cost(values);
}

/// The metric of a vertex times how far it is off.
Vec3 Fitter::weighted(Eigen::Index vertex, const Vec3& difference) const {
  if (slide_normals_.size() == 0) return vertex_weights_[vertex] * difference;
  const Vec3 normal = slide_normals_.segment<3>(3 * vertex);
  if (normal.isZero(0)) return vertex_weights_[vertex] * difference;
  return vertex_weights_[vertex] *
         (along_surface * difference + (1.0 - along_surface) * normal.dot(difference) * normal);
}

void Fitter::gather_sliding() {
  std::vector<Eigen::Index> used;
  for (Eigen::Index v = 0; v < vertex_weights_.size(); ++v)
    if (vertex_weights_[v] > 0.0) used.push_back(v);
  const auto count = node_columns_.cols();
  Eigen::MatrixXd slopes(3 * static_cast<Eigen::Index>(used.size()), count), scaled(slopes.rows(), count);
  for (size_t i = 0; i < used.size(); ++i) {
    Eigen::MatrixXd rows = Eigen::MatrixXd::Zero(3, count);
    for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator it(subject_->weights(), used[i]); it;
         ++it)
      rows += it.value() * node_columns_.middleRows<3>(3 * it.col());
    rows.rightCols<3>() += jaw_slopes_.middleRows<3>(3 * used[i]);
    slopes.middleRows<3>(3 * static_cast<Eigen::Index>(i)) = rows;
    for (Eigen::Index c = 0; c < count; ++c)
      scaled.block<3, 1>(3 * static_cast<Eigen::Index>(i), c) = weighted(used[i], rows.col(c));
  }
  hessian_ = dense::transposed_product(slopes, scaled);
}

bool Fitter::linearise(const std::vector<float>& values, const sim::Positions& nodes) {
  if (!sensitivity_.linearise(subject_->controls(values), nodes)) return false;
  secants_.clear();
  linear_at_ = values;
  const Eigen::MatrixXd own = sensitivity_.columns(driven_);
  node_columns_.resize(own.rows(), own.cols() + 3);
  node_columns_ << own, sensitivity_.jaw_columns();
  jaw_slopes_ = subject_->jaw_slopes(values);
  if (slide_normals_.size() > 0) {
    gather_sliding();
    hessian_ *= square_mm;
    return true;
  }
  hessian_ = square_mm * gathered(vertex_weights_);
  if (!visibility_.is_whole())
    visibility_.find(hessian_.diagonal() / square_mm, gathered(visibility_.ever() / confidence_).diagonal());
  return true;
}

Eigen::MatrixXd Fitter::gathered(const Eigen::VectorXd& vertex_weights) const {
  const auto& weights = subject_->weights();
  const Eigen::SparseMatrix<double> weighted = weights.transpose() * vertex_weights.asDiagonal();
  const Eigen::SparseMatrix<double> between = weighted * weights;
  const auto count = node_columns_.cols();
  Eigen::MatrixXd hessian = Eigen::MatrixXd::Zero(count, count);
  for (int axis = 0; axis < 3; ++axis) {
    const Eigen::MatrixXd columns = axis_rows(node_columns_, axis), jaw = axis_rows(jaw_slopes_, axis);
    const Eigen::MatrixXd across_nodes = between * columns;
    dense::add_transposed_product(1.0, columns, across_nodes, hessian);
    const Eigen::MatrixXd pulled = weighted * jaw;
    const Eigen::MatrixXd across = dense::transposed_product(columns, pulled);
    hessian.rightCols<3>() += across;
    hessian.bottomRows<3>() += across.transpose();
    hessian.bottomRightCorner<3, 3>() += jaw.transpose() * vertex_weights.asDiagonal() * jaw;
  }
  return hessian;
}

/// Turns each eye as its vertices turn, by the rotation of least squares about its centre (Kabsch 1976). One
/// that is not seen is left to the fit: lids follow the gaze.
void Fitter::find_eyes(const Target& target, std::vector<float>& values) {
  const rig::Skull& skull = subject_->file().rig.skull;
  std::array<bool, 2> seen = {false, false};
  for (const uint8_t eye : {uint8_t{1}, uint8_t{2}}) {
    const Vec3 centre = (eye == 1 ? skull.eye_left : skull.eye_right).centre.cast<double>();
    Mat3 sum = Mat3::Zero();
    double most = 0.0;
    for (size_t v = 0; v < subject_->vertex_count(); ++v) {
      if (subject_->eyes()[v] != eye || target.confidence[v] <= 0.0) continue;
      seen[eye - 1U] = true;
      const auto at = static_cast<Eigen::Index>(3 * v);
      const Vec3 arm = subject_->rest().segment<3>(at) - centre, moved = target.displacements.segment<3>(at);
      sum += (arm + moved) * arm.transpose();
      most = std::max(most, moved.norm());
    }
    if (most < 1e-5) continue;
    const Mat3 turn = nearest_rotation(sum);
    const Vec3 gaze = turn.col(2);
    const std::string side = eye == 1 ? "left" : "right";
    for (const auto& [name, angle] : {std::pair{"eye_yaw_", std::atan2(gaze.x(), gaze.z())},
                                      std::pair{"eye_pitch_", std::asin(std::clamp(gaze.y(), -1.0, 1.0))}}) {
      const int32_t at = subject_->channel(name + side);
      if (at < 0) continue;
      const rig::Channel& channel = subject_->channels()[static_cast<size_t>(at)];
      values[static_cast<size_t>(at)] =
          std::clamp(static_cast<float>(angle), channel.minimum, channel.maximum);
    }
  }
  hold(seen);
}

void Fitter::take_weights(const Target& target, bool is_next) {
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(subject_->vertex_count()));
  for (size_t v = 0; v < subject_->vertex_count(); ++v)
    if (subject_->follows(v)) weights[static_cast<Eigen::Index>(v)] = target.confidence[v];
  confidence_ = weights.sum();
  if (!(confidence_ > 0.0)) throw Error("the target contains no vertices that the muscles move");
  visibility_.begin(weights, is_next);
  weights /= confidence_;
  if (vertex_weights_.size() != weights.size() || vertex_weights_ != weights) linear_at_.clear();
  if (target.normals.size() > 0 || slide_normals_.size() > 0) linear_at_.clear();
  vertex_weights_ = weights;
  slide_normals_ = target.normals;
}

Eigen::VectorXd Fitter::pulls(const Eigen::VectorXd& difference) const {
  Eigen::VectorXd pulls(difference.size());
  for (Eigen::Index v = 0; v < vertex_weights_.size(); ++v)
    pulls.segment<3>(3 * v) = square_mm * weighted(v, difference.segment<3>(3 * v));
  return pulls;
}

Eigen::VectorXd Fitter::slope_of(const Eigen::VectorXd& difference, bool by_columns) const {
  Eigen::MatrixXd pulls(vertex_weights_.size(), 3);
  for (Eigen::Index v = 0; v < pulls.rows(); ++v)
    pulls.row(v) = square_mm * weighted(v, difference.segment<3>(3 * v)).transpose();
  const Eigen::MatrixXd by_node = subject_->weights().transpose() * pulls;
  Eigen::VectorXd slope_by_node(node_columns_.rows());
  for (Eigen::Index n = 0; n < by_node.rows(); ++n)
    slope_by_node.segment<3>(3 * n) = by_node.row(n).transpose();
  Eigen::VectorXd slope = by_columns ? Eigen::VectorXd(node_columns_.transpose() * slope_by_node)
                                     : sensitivity_.adjoint(slope_by_node, driven_);
  for (int axis = 0; axis < 3; ++axis)
    slope.tail<3>() += axis_rows(jaw_slopes_, axis).transpose() * pulls.col(axis);
  return slope;
}

Linearised Fitter::linearised(const Target& target, const std::vector<float>& values) {
  take_weights(target, false);
  last_.clear();
  is_sequence_ = false;
  Eigen::VectorXd difference;
  objective(target, values, false, difference);
  if (!linearise(values, subject_->nodes()))
    throw Error(
        "the pose has no derivative: its stiffness matrix is singular (some tissue is unconstrained)");
  Linearised out{fitted_, hessian_, slope_of(difference, false), 0.0, 0.0};
  for (Eigen::Index v = 0; v < vertex_weights_.size(); ++v) {
    if (!(vertex_weights_[v] > 0.0)) continue;
    const Vec3 gap = difference.segment<3>(3 * v), wanted = target.displacements.segment<3>(3 * v);
    out.mean_square += square_mm * gap.dot(weighted(v, gap));
    out.target_square += square_mm * wanted.dot(weighted(v, wanted));
  }
  return out;
}

void Fitter::finish(const Target& target, FitResult& result) {
  if (!is_sequence_) subject_->pose(result.activations, false);
  result.displacements = subject_->displacements(result.activations);
  Misses misses;
  for (size_t v = 0; v < subject_->vertex_count(); ++v) {
    if (target.confidence[v] <= 0.0) continue;
    const auto at = static_cast<Eigen::Index>(3 * v);
    const Vec3 wanted = target.displacements.segment<3>(at),
               gap = result.displacements.segment<3>(at) - wanted;
    misses.add(gap.norm(), wanted.norm(), target.confidence[v]);
  }
  misses.write(result);
  result.spread.assign(result.activations.size(), 0.0);
  if (hessian_.size() == 0) return;
  constexpr double held_curvature = 1e12;
  Eigen::MatrixXd curvature = hessian_;
  for (Eigen::Index i = 0; i < curvature.rows(); ++i)
    curvature(i, i) += is_held_[fitted_[static_cast<size_t>(i)]]
                           ? held_curvature
                           : options_.ridge * dearness_[fitted_[static_cast<size_t>(i)]] + 1e-12;
  const Eigen::MatrixXd inverse =
      curvature.ldlt().solve(Eigen::MatrixXd::Identity(curvature.rows(), curvature.cols()));
  constexpr double rise_mm = 0.05;
  for (Eigen::Index i = 0; i < inverse.rows(); ++i) {
    if (is_held_[fitted_[static_cast<size_t>(i)]]) continue;
    const rig::Channel& channel = subject_->channels()[fitted_[static_cast<size_t>(i)]];
    result.spread[fitted_[static_cast<size_t>(i)]] =
        std::min(static_cast<double>(channel.maximum - channel.minimum),
                 rise_mm * std::sqrt(std::max(0.0, inverse(i, i))));
    for (Eigen::Index j = 0; j < i; ++j) {
      const uint32_t a = fitted_[static_cast<size_t>(j)], b = fitted_[static_cast<size_t>(i)];
      const bool in_use = std::max(std::abs(result.activations[a]), std::abs(result.activations[b])) > 0.02F;
      if (in_use && std::abs(inverse(i, j)) > 0.9 * std::sqrt(inverse(i, i) * inverse(j, j)))
        result.alike.emplace_back(a, b);
    }
  }
}

}  // namespace fascia::fit
