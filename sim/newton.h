#pragma once

#include "sim/curvature.h"
#include "sim/minimise.h"

namespace fascia::sim {

struct NewtonOptions {
  int iterations = 60;         ///< Newton steps
  int inner_iterations = 120;  ///< of conjugate gradients per step
  double forcing = 0.05;       ///< relative residual of the preconditioned system at which a step ends
};

/// Workspace of `newton` in addition to `MinimiseWorkspace`.
struct NewtonWorkspace {
  Curvature curvature;
  Positions step, direction, product;  // by node, zero where prescribed
  Positions residual;                  // by unknown
  std::vector<double> weights;         // by unknown: newton per metre, what damping multiplies
  void resize(size_t nodes, size_t unknowns) {
    for (Positions* list : {&step, &direction, &product})
      list->resize(nodes, Vec3::Zero());
    residual.resize(unknowns, Vec3::Zero());
    weights.resize(unknowns, 0.0);
  }
};

namespace detail {

/// n.step := about -H^-1 w.gradient: conjugate gradients, the rest factor as preconditioner. Returns
/// iterations.
inline int newton_step(const RestFactor& factor, const std::vector<uint32_t>& unknowns,
                       const NewtonOptions& options, double damping, MinimiseWorkspace& w,
                       NewtonWorkspace& n) {
  std::fill(n.step.begin(), n.step.end(), Vec3::Zero());
  std::fill(n.direction.begin(), n.direction.end(), Vec3::Zero());
  for (size_t i = 0; i < unknowns.size(); ++i)
    w.packed[i] = n.residual[i] = -w.gradient[unknowns[i]];
  factor.solve(w.packed, w.scratch);
  double energy = dot(w.packed, n.residual);
  const double enough = options.forcing * options.forcing * energy;
  for (size_t i = 0; i < unknowns.size(); ++i)
    n.direction[unknowns[i]] = w.packed[i];
  int iteration = 0;
  while (iteration < options.inner_iterations && energy > enough && energy > 0.0) {
    std::fill(n.product.begin(), n.product.end(), Vec3::Zero());
    n.curvature.times(n.direction.data(), n.product.data());
    for (size_t i = 0; i < unknowns.size(); ++i)
      n.product[unknowns[i]] += damping * n.weights[i] * n.direction[unknowns[i]];
    double curvature = 0.0;
    for (const uint32_t node : unknowns)
      curvature += n.direction[node].dot(n.product[node]);
    if (!(curvature > 0.0)) break;
    const double length = energy / curvature;
    for (size_t i = 0; i < unknowns.size(); ++i) {
      n.step[unknowns[i]] += length * n.direction[unknowns[i]];
      n.residual[i] -= length * n.product[unknowns[i]];
      w.packed[i] = n.residual[i];
    }
    factor.solve(w.packed, w.scratch);
    const double next = dot(w.packed, n.residual);
    for (size_t i = 0; i < unknowns.size(); ++i)
      n.direction[unknowns[i]] = w.packed[i] + (next / energy) * n.direction[unknowns[i]];
    energy = next;
    ++iteration;
  }
  return iteration;
}

}  // namespace detail

/// Minimises `function(x, gradient)` over the nodes `unknowns` of `x` by Newton steps with the projected
/// Hessian of `find_curvature(x, Curvature&)`, each solved by conjugate gradients with the rest factor as
/// preconditioner, with a backtracking line search (Nocedal & Wright 2006, algorithm 7.1). For poses in which
/// quasi-Newton steps do not converge: stiff contact, collapsed triangles.
template <class Function, class FindCurvature>
MinimiseResult newton(Function&& function, FindCurvature&& find_curvature, const RestFactor& factor,
                      const std::vector<uint32_t>& unknowns, const NewtonOptions& options, double tolerance,
                      MinimiseWorkspace& w, NewtonWorkspace& n, Positions& x) {
  MinimiseResult result;
  double value = function(x.data(), w.gradient.data()), damping = 0.0;
  for (int iteration = 0;; ++iteration) {
    result.residual = detail::largest(w.gradient);
    if (!std::isfinite(value) || !std::isfinite(result.residual)) return result;
    find_curvature(x.data(), n.curvature);
    result.iterations += 1 + detail::newton_step(factor, unknowns, options, damping, w, n);
    result.move = detail::largest(n.step);
    if (result.move <= tolerance) {
      result.converged = true;
      return result;
    }
    if (iteration >= options.iterations) return result;
    double slope = 0.0;
    for (const uint32_t node : unknowns)
      slope += n.step[node].dot(w.gradient[node]);
    if (!(slope < 0.0)) return result;
    double length = std::min(1.0, 0.02 / result.move), trial_value = 0.0;
    bool fell = false;
    for (int halving = 0; halving < 24 && !fell; ++halving) {
      w.trial = x;
      for (const uint32_t node : unknowns)
        w.trial[node] += length * n.step[node];
      trial_value = function(w.trial.data(), w.trial_gradient.data());
      fell = trial_value <= value + 1e-4 * length * slope;
      if (!fell) length *= 0.5;
    }
    if (!fell) return result;
    // Where a step was shortened the quadratic model is poor: damp it (Levenberg and Marquardt).
    damping = length < 1.0 ? std::clamp(4.0 * damping, 0.05, 20.0) : damping > 0.02 ? 0.25 * damping : 0.0;
    std::swap(x, w.trial);
    std::swap(w.gradient, w.trial_gradient);
    value = trial_value;
  }
}

}  // namespace fascia::sim
