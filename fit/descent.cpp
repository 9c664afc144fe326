#include <algorithm>
#include <cmath>

#include "fit/fit.h"
#include "fit/live/bounded_step.h"

// How a fit goes down: Gauss-Newton steps in a box, by a Jacobian that learns from each step.

namespace fascia::fit {
namespace {

constexpr double farthest_step = 1.0;  // of a channel, in one step
constexpr double stale = 0.4;          // of a channel, from where the Jacobian was computed; in a take...
constexpr double stale_in_take = 0.15;
constexpr int most_attempts = 8;
constexpr int most_attempts_in_take = 3;
constexpr double nothing_gained = 1e-7;  // mm^2

}  // namespace

FitResult Fitter::solve(const Target& target, bool is_next) {
  take_weights(target, is_next);
  std::vector<float> values;
  for (const rig::Channel& channel : subject_->channels())
    values.push_back(channel.rest);
  if (is_next)
    values = last_;
  else
    last_.clear();
  find_eyes(target, values);
  FitResult result;
  Descent at{std::move(values), {}, {}, 0.0, farthest_step, false};
  at.value = objective(target, at.values, is_next, at.difference);
  at.nodes = subject_->nodes();
  while (result.iterations < options_.iterations && !result.converged) {
    const Progress progress = descend(target, is_next, at);
    if (progress == Progress::stuck) break;
    result.converged = progress == Progress::ends;
    ++result.iterations;
  }
  result.activations = at.values;
  if (is_sequence_) {
    last_ = at.values;
    subject_->pose(at.values, true);
  }
  finish(target, result);
  return result;
}

bool Fitter::renew_jacobian(bool is_next, Descent& at) {
  double away = linear_at_.empty() || at.needs_jacobian ? farthest_step : 0.0;
  for (size_t c = 0; c < linear_at_.size(); ++c)
    away = std::max(away, static_cast<double>(std::abs(linear_at_[c] - at.values[c])));
  at.is_fresh = away > (is_next ? stale_in_take : stale);
  if (!at.is_fresh) return true;
  const double cost_before = cost(at.values);
  if (!linearise(at.values, at.nodes)) return false;
  at.needs_jacobian = false;
  at.value += cost(at.values) - cost_before;  // which depends on what of each channel is seen
  if (!is_next && cost(at.values) > 0.0) learn_gradient(at.difference);  // at rest the columns are exact
  return true;
}

/// A Gauss-Newton step in a box of the channels (Nocedal & Wright 2006, section 4.1): single channels, as of
/// lips that touch, bend far more than the others, which the box lets go on. Poses of a single target are
/// solved from rest, so that equal activations give equal poses.
Fitter::Progress Fitter::descend(const Target& target, bool is_next, Descent& at) {
  if (!renew_jacobian(is_next, at)) return Progress::stuck;
  const Eigen::VectorXd slope = slope_at(at);
  const int attempts = is_next ? most_attempts_in_take : most_attempts;
  const double shrinking = is_next ? 0.25 : 0.5;  // a take's poses, solved from the last, tell of no less
  for (int attempt = 0; attempt < attempts; ++attempt) {
    const Eigen::VectorXd move = step(slope, at.values, at.radius);
    const double moved = move.cwiseAbs().maxCoeff();
    if (moved < 1e-4) break;
    std::vector<float> trial = at.values;
    for (Eigen::Index i = 0; i < move.size(); ++i)
      trial[fitted_[static_cast<size_t>(i)]] += static_cast<float>(move[i]);
    Eigen::VectorXd difference;
    const double value = objective(target, trial, is_next, difference);
    if (!is_next) learn_step(move, difference - at.difference);
    if (!(value < at.value)) {
      at.radius = shrinking * moved;
      at.needs_jacobian = !at.is_fresh && attempt >= 2;
      if (at.needs_jacobian) return Progress::falls;
      continue;
    }
    const double gain = at.value - value;
    const bool is_bounded = moved > 0.99 * at.radius;
    if (is_bounded && attempt == 0) at.radius = std::min(farthest_step, 2.0 * at.radius);
    at.values = std::move(trial);
    at.value = value;
    at.difference = std::move(difference);
    at.nodes = subject_->nodes();
    const bool is_small = moved < 2e-3 || gain < 1e-4 * value + nothing_gained;
    return is_small && !is_bounded ? Progress::ends : Progress::falls;
  }
  return Progress::ends;  // no step decreases the objective
}

/// Half the gradient of the objective, the price of sizes apart.
Eigen::VectorXd Fitter::slope_at(const Descent& at) const {
  Eigen::VectorXd slope = slope_by_columns(at.difference);
  for (Eigen::Index i = 0; i < slope.size(); ++i) {
    const uint32_t c = fitted_[static_cast<size_t>(i)];
    slope[i] += price(options_.ridge, static_cast<size_t>(i)) * static_cast<double>(at.values[c]);
    if (!last_.empty())
      slope[i] += price_of_change(static_cast<size_t>(i)) * static_cast<double>(at.values[c] - last_[c]);
  }
  return slope;
}

Eigen::VectorXd Fitter::slope_by_columns(const Eigen::VectorXd& difference) const {
  Eigen::VectorXd slope = slope_of(difference, true);
  if (secants_.empty()) return slope;
  const Eigen::VectorXd pull = pulls(difference);
  for (const Secant& secant : secants_)
    slope += secant.miss.dot(pull) / secant.square * secant.move;
  return slope;
}

void Fitter::learn_step(const Eigen::VectorXd& move, const Eigen::VectorXd& moved) {
  constexpr double least = 1e-7;
  const double square = move.squaredNorm();
  if (square < least) return;
  Eigen::VectorXd miss = moved - jaw_slopes_ * move.tail<3>();
  const Eigen::VectorXd by_node = node_columns_ * move;
  Eigen::MatrixXd rows(by_node.size() / 3, 3);
  for (Eigen::Index n = 0; n < rows.rows(); ++n)
    rows.row(n) = by_node.segment<3>(3 * n).transpose();
  const Eigen::MatrixXd by_vertex = subject_->weights() * rows;
  for (Eigen::Index v = 0; v < by_vertex.rows(); ++v)
    miss.segment<3>(3 * v) -= by_vertex.row(v).transpose();
  for (const Secant& secant : secants_)
    miss -= secant.move.dot(move) / secant.square * secant.miss;
  learn({std::move(miss), move, square});
}

void Fitter::learn_gradient(const Eigen::VectorXd& difference) {
  const double square = difference.dot(pulls(difference));
  if (square > 0.0) learn({difference, slope_of(difference, false) - slope_of(difference, true), square});
}

/// Adds the secant to the Hessian of the columns, and to the list.
void Fitter::learn(Secant secant) {
  const Eigen::VectorXd across = slope_by_columns(secant.miss), unit = secant.move / secant.square;
  hessian_ += across * unit.transpose() + unit * across.transpose() +
              secant.miss.dot(pulls(secant.miss)) * unit * unit.transpose();
  secants_.push_back(std::move(secant));
}

/// The step of least half-objective in the channels' ranges and no farther than `radius`, by coordinate
/// descent: `slope` is half the objective's gradient without the price of sizes.
Eigen::VectorXd Fitter::step(const Eigen::VectorXd& slope, const std::vector<float>& values,
                             double radius) const {
  const auto count = static_cast<Eigen::Index>(fitted_.size());
  Eigen::MatrixXd curvature = hessian_;
  for (Eigen::Index i = 0; i < count; ++i)
    curvature(i, i) +=
        price(options_.ridge, static_cast<size_t>(i)) + price_of_change(static_cast<size_t>(i)) + 1e-12;
  std::vector<StepBound> bounds(fitted_.size());
  for (size_t i = 0; i < bounds.size(); ++i) {
    const rig::Channel& channel = subject_->channels()[fitted_[i]];
    const double value = values[fitted_[i]];
    bounds[i] = {std::max(static_cast<double>(channel.minimum), value - radius),
                 std::min(static_cast<double>(channel.maximum), value + radius), price(options_.sparsity, i),
                 is_held_[fitted_[i]]};
  }
  Eigen::VectorXd move(count), pull;
  bounded_step(
      curvature, slope, [&](Eigen::Index i) -> const StepBound& { return bounds[static_cast<size_t>(i)]; },
      [&](Eigen::Index i) { return static_cast<double>(values[fitted_[static_cast<size_t>(i)]]); }, move,
      pull);
  return move;
}

}  // namespace fascia::fit
