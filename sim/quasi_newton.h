#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace fascia::sim {

struct MinimiseOptions {
  int iterations = 200;
  double tolerance = 2e-6;     ///< metres: the largest move of a node the solver still wants to make
  double longest_step = 0.02;  ///< metres a node may go at once: farther, triangles turn inside out
};

struct MinimiseResult {
  int iterations = 0;
  double move = 0.0;      ///< metres: largest move of a node still wanted at the end
  double residual = 0.0;  ///< newton: largest force left on a node
  bool converged = false;
};

/// How a line search judges its steps; the rounding is that of the numbers an energy is summed in.
struct LineSearch {
  int halvings = 24;              ///< at most, before a direction is given up
  double rounding = 1e-14;        ///< of an energy, relative: below it the slope tells
  double least_curvature = 1e-6;  ///< share of a step's slope that its change of the gradient must show
};

/// Where a line search looks next after a step of `length` did not do: at the minimum of the cubic through
/// both ends' values and slopes (Nocedal & Wright 2006, equation 3.59), or where values differ by less than
/// their rounding where the slopes say it is flat; between a tenth and a half of the step. Slopes are those
/// of a whole step.
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
/// Bouaziz & Kavan 2017, algorithm 1), with backtracking by interpolation until the function falls (Armijo):
/// one text for every number type. Moves the unknowns of `space` to a minimum; on return they are at the best
/// point found, and where the function is not finite at the start they stay as they were. Allocates nothing
/// if `space` does not.
///
/// A space holds the unknowns x and the lists the method works on:
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
  bool interpolates = true;  // where rounding misleads interpolation, plain halving has the last word
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
    if (!(slope < 0.0)) {  // the corrections mislead: begin again from the preconditioner alone
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
      // Where energies differ by less than their rounding, the slope tells (Hager & Zhang 2005, approximate
      // Wolfe conditions).
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
      if (count == 0 && !interpolates) return result;  // as low as rounding lets it go
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
