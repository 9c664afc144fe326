#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace fascia::sim {

struct MinimiseOptions {
  int iterations = 200;
  double tolerance = 2e-6;     ///< metres: convergence when no node would move farther
  double longest_step = 0.02;  ///< metres: largest step of a node; longer steps may invert triangles
};

struct MinimiseResult {
  int iterations = 0;
  double move = 0.0;      ///< metres: length of the next step at the end, largest of any node
  double residual = 0.0;  ///< newton: largest residual force on a node
  bool converged = false;
};

/// Options of a line search; the rounding is that of the type an energy is summed in.
struct LineSearch {
  int halvings = 24;        ///< maximum number before a direction is abandoned
  double rounding = 1e-14;  ///< relative rounding error of an energy: below it slopes are compared instead
  double least_curvature = 1e-6;  ///< least change of the gradient along a step, relative to its slope
};

/// The next trial step of a line search after `length` was rejected: the minimum of the cubic through the
/// values and slopes at both ends (Nocedal & Wright 2006, equation 3.59), or, if the values differ by less
/// than their rounding error, the zero of the interpolated slope; between a tenth and a half of the step.
/// Slopes are those of a full step.
inline double shorter_step(double length, double value, double slope, double trial, double trial_slope,
                           double rounding) {
  constexpr double least = 0.1, most = 0.5;
  double next = most * length;
  if (!std::isfinite(trial) || !std::isfinite(trial_slope)) return next;
  if (std::abs(trial - value) <= rounding * std::abs(value)) {
    if (trial_slope > slope) next = length * slope / (slope - trial_slope);
  } else {
    const double first = slope + trial_slope - 3.0 * (trial - value) / length;
    const double squared = first * first - slope * trial_slope;
    if (squared >= 0.0) {
      const double second = std::sqrt(squared);
      next = length - length * (trial_slope + second - first) / (trial_slope - slope + 2.0 * second);
    }
  }
  return std::isfinite(next) ? std::clamp(next, least * length, most * length) : most * length;
}

/// The limited-memory BFGS method on a preconditioner (Nocedal & Wright 2006, algorithms 7.4 and 7.5; Liu,
/// Bouaziz & Kavan 2017, algorithm 1), with a backtracking line search by interpolation (Armijo condition),
/// for every number type. Minimises over the unknowns of `space`; on return they are at the best point found,
/// or unchanged if the function is not finite at the start. Does not allocate unless `space` does.
///
/// A space contains the unknowns x and the vectors of the method:
///   history                     how many corrections are kept
///   double evaluate()           function at x, newton metre; writes the gradient
///   double residual()           largest force on a node, newton
///   void start_direction()      direction := gradient
///   void precondition()         direction := P^-1 direction
///   double step_dot(slot)       step . direction       double change_dot(slot)   change . direction
///   void add_step(f, slot)      direction += f step    void add_change(f, slot)  direction += f change
///   void negate()               direction := -direction
///   double slope()              direction . gradient
///   double longest()            largest move of a node along direction, metres
///   void go(length)             x += length direction
///   void keep_gradient()        the gradient is kept as the one before; undone by calling it again
///   double remember(slot, length)   step := length direction, change := gradient - the one before; their
///   product
template <class Space>
MinimiseResult minimise(Space& space, const MinimiseOptions& options, const LineSearch& search) {
  constexpr size_t history = Space::history;
  MinimiseResult result;
  std::array<double, history> curvatures{};
  size_t first = 0, count = 0;
  bool interpolates = true;  // where rounding spoils the interpolation, halving is the fallback
  double value = space.evaluate();
  for (int iteration = 0;; ++iteration) {
    result.iterations = iteration;
    result.residual = space.residual();
    if (!std::isfinite(value) || !std::isfinite(result.residual)) return result;
    space.start_direction();
    std::array<double, history> share{};
    for (size_t k = count; k-- > 0;) {
      const size_t slot = (first + k) % history;
      share[k] = space.step_dot(slot) / curvatures[slot];
      space.add_change(-share[k], slot);
    }
    space.precondition();
    for (size_t k = 0; k < count; ++k) {
      const size_t slot = (first + k) % history;
      space.add_step(share[k] - space.change_dot(slot) / curvatures[slot], slot);
    }
    space.negate();
    result.move = space.longest();
    if (result.move <= options.tolerance) {
      result.converged = true;
      return result;
    }
    if (iteration >= options.iterations) return result;
    const double slope = space.slope();
    if (!(slope < 0.0)) {  // not a descent direction: restart with the preconditioner alone
      if (count == 0) return result;
      count = 0;
      continue;
    }
    double length = std::min(1.0, options.longest_step / result.move), trial = 0.0;
    space.go(length);
    space.keep_gradient();
    bool fell = false;
    for (int halving = 0; halving < search.halvings; ++halving) {
      trial = space.evaluate();
      // Where energies differ by less than their rounding error, compare slopes (Hager & Zhang 2005,
      // approximate Wolfe conditions).
      fell = trial <= value + 1e-4 * length * slope || (trial <= value + search.rounding * std::abs(value) &&
                                                        std::abs(space.slope()) <= 0.9 * std::abs(slope));
      if (fell) break;
      const double next = interpolates
                              ? shorter_step(length, value, slope, trial, space.slope(), search.rounding)
                              : 0.5 * length;
      space.go(next - length);
      length = next;
    }
    if (!fell) {
      space.go(-length);
      space.keep_gradient();
      if (count == 0 && !interpolates) return result;  // converged to rounding error
      interpolates = count > 0;
      count = 0;
      continue;
    }
    const size_t slot = (first + count) % history;
    const double curvature = space.remember(slot, length);
    if (curvature > search.least_curvature * length * std::abs(slope)) {
      curvatures[slot] = curvature;
      if (count < history)
        ++count;
      else
        first = (first + 1) % history;
    }
    interpolates = true;
    value = trial;
  }
}

}  // namespace fascia::sim
