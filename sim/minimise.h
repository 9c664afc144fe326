#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "sim/rest_factor.h"

namespace fascia::sim {

struct MinimiseOptions {
  int iterations = 200;
  double tolerance = 2e-6;  ///< metres: the largest move of a node the solver still wants to make
};

struct MinimiseResult {
  int iterations = 0;
  double move = 0.0;      ///< metres: largest move of a node still wanted at the end
  double residual = 0.0;  ///< newton: largest force left on a node
  bool converged = false;
};

/// What `minimise` needs of memory; sized once, reused by every solve.
struct MinimiseWorkspace {
  static constexpr size_t history = 10;
  Positions gradient, direction, trial, trial_gradient, packed, scratch;
  std::vector<Positions> steps, changes;
  std::vector<double> curvatures;

  MinimiseWorkspace(size_t nodes, size_t unknowns)
      : gradient(nodes),
        direction(nodes),
        trial(nodes),
        trial_gradient(nodes),
        packed(unknowns),
        scratch(unknowns),
        steps(history, Positions(unknowns)),
        changes(history, Positions(unknowns)),
        curvatures(history, 0.0) {}
};

namespace detail {

inline double dot(const Positions& a, const Positions& b) {
  double sum = 0.0;
  for (size_t i = 0; i < a.size(); ++i)
    sum += a[i].dot(b[i]);
  return sum;
}

inline double largest(const Positions& a) {
  double most = 0.0;
  for (const Vec3& v : a)
    most = std::max(most, v.squaredNorm());
  return std::sqrt(most);
}

/// packed := -H packed, H the limited-memory inverse Hessian on top of the rest factor
/// (Nocedal & Wright 2006, algorithm 7.4; Liu, Bouaziz & Kavan 2017, algorithm 1).
inline void search_direction(const RestFactor& factor, MinimiseWorkspace& w, size_t first, size_t count) {
  constexpr size_t history = MinimiseWorkspace::history;
  double share[history] = {};
  for (size_t k = count; k-- > 0;) {
    const size_t slot = (first + k) % history;
    share[k] = dot(w.steps[slot], w.packed) / w.curvatures[slot];
    for (size_t i = 0; i < w.packed.size(); ++i)
      w.packed[i] -= share[k] * w.changes[slot][i];
  }
  factor.solve(w.packed, w.scratch);
  for (size_t k = 0; k < count; ++k) {
    const size_t slot = (first + k) % history;
    const double back = share[k] - dot(w.changes[slot], w.packed) / w.curvatures[slot];
    for (size_t i = 0; i < w.packed.size(); ++i)
      w.packed[i] += back * w.steps[slot][i];
  }
  for (Vec3& v : w.packed)
    v = -v;
}

}  // namespace detail

/// Moves the nodes `unknowns` of `x` (#nodes) to a minimum of `function(x, gradient)`: quasi-Newton steps
/// on the rest factor, each with backtracking until the function falls (Armijo). Allocates nothing. On return
/// `x` is the best point found; a function that is not finite at the start leaves `x` as it was.
template <class Function>
MinimiseResult minimise(Function&& function, const RestFactor& factor, const std::vector<uint32_t>& unknowns,
                        const MinimiseOptions& options, MinimiseWorkspace& w, Positions& x) {
  constexpr size_t history = MinimiseWorkspace::history;
  MinimiseResult result;
  size_t first = 0, count = 0;
  double value = function(x.data(), w.gradient.data());
  for (int iteration = 0;; ++iteration) {
    result.iterations = iteration;
    result.residual = detail::largest(w.gradient);
    if (!std::isfinite(value) || !std::isfinite(result.residual)) return result;
    for (size_t i = 0; i < unknowns.size(); ++i)
      w.packed[i] = w.gradient[unknowns[i]];
    detail::search_direction(factor, w, first, count);
    result.move = detail::largest(w.packed);
    if (result.move <= options.tolerance) {
      result.converged = true;
      return result;
    }
    if (iteration >= options.iterations) return result;
    double slope = 0.0;
    for (size_t i = 0; i < unknowns.size(); ++i)
      slope += w.packed[i].dot(w.gradient[unknowns[i]]);
    if (!(slope < 0.0)) {  // the history misleads: begin again from the rest factor alone
      if (count == 0) return result;
      count = 0;
      continue;
    }
    double length = std::min(1.0, 0.02 / result.move), trial_value = 0.0;  // at most 20 mm a step
    bool fell = false;
    for (int halving = 0; halving < 24 && !fell; ++halving) {
      w.trial = x;
      for (size_t i = 0; i < unknowns.size(); ++i)
        w.trial[unknowns[i]] += length * w.packed[i];
      trial_value = function(w.trial.data(), w.trial_gradient.data());
      fell = trial_value <= value + 1e-4 * length * slope;
      if (!fell) length *= 0.5;
    }
    if (!fell) {
      if (count == 0) return result;  // as low as rounding lets it go
      count = 0;
      continue;
    }
    const size_t slot = (first + count) % history;
    double curvature = 0.0, change_squared = 0.0, step_squared = 0.0;
    for (size_t i = 0; i < unknowns.size(); ++i) {
      const uint32_t node = unknowns[i];
      w.steps[slot][i] = w.trial[node] - x[node];
      w.changes[slot][i] = w.trial_gradient[node] - w.gradient[node];
      curvature += w.steps[slot][i].dot(w.changes[slot][i]);
      change_squared += w.changes[slot][i].squaredNorm();
      step_squared += w.steps[slot][i].squaredNorm();
    }
    if (curvature > 1e-10 * std::sqrt(change_squared * step_squared)) {
      w.curvatures[slot] = curvature;
      if (count < history)
        ++count;
      else
        first = (first + 1) % history;
    }
    std::swap(x, w.trial);
    std::swap(w.gradient, w.trial_gradient);
    value = trial_value;
  }
}

}  // namespace fascia::sim
