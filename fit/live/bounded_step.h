#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>

namespace fascia::fit {

/// Bounds and penalty of one unknown of a bounded step.
struct StepBound {
  double least = 0.0, most = 1.0;  ///< of the value after the step
  double price = 0.0;              ///< of the absolute value, in units of the objective
  bool is_held = false;            ///< is kept fixed
};

/// The minimiser of slope y + curvature y^2 / 2 + price |value + y| / 2 within limits.
inline double best_move(double slope, double curvature, double value, const StepBound& bound) {
  if (!(curvature > 0.0)) return 0.0;
  const double free = value - slope / curvature, threshold = 0.5 * bound.price / curvature;
  const double shrunk = free > threshold ? free - threshold : free < -threshold ? free + threshold : 0.0;
  return std::clamp(shrunk, bound.least, bound.most) - value;
}

/// Minimises slope . y + y . curvature y / 2 + sum price |value + y| / 2 with least <= value + y <= most, by
/// coordinate descent (Friedman, Hastie & Tibshirani 2010, "Regularization paths for generalized linear
/// models via coordinate descent", section 2). `curvature` is symmetric and positive definite, `bound(i)`
/// gives the StepBound of unknown i, `value(i)` its current value. It ends when a complete sweep changes none
/// by more than `enough`. Writes the step to `move` and uses `pull`; both #unknowns. Allocates nothing.
template <class Bound, class Value>
void bounded_step(const Eigen::MatrixXd& curvature, const Eigen::VectorXd& slope, const Bound& bound,
                  const Value& value, Eigen::VectorXd& move, Eigen::VectorXd& pull, double enough = 1e-6) {
  constexpr int sweeps = 400;
  move.setZero();
  pull = slope;  // slope + curvature move
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    double largest = 0.0;
    for (Eigen::Index i = 0; i < move.size(); ++i) {
      const StepBound& limits = bound(i);
      if (limits.is_held) continue;
      const double next = best_move(pull[i] - curvature(i, i) * move[i], curvature(i, i), value(i), limits);
      const double change = next - move[i];
      if (change == 0.0) continue;
      pull += change * curvature.col(i);
      move[i] = next;
      largest = std::max(largest, std::abs(change));
    }
    if (largest < enough) break;
  }
}

}  // namespace fascia::fit
