#pragma once

#include <vector>

#include "sim/quasi_newton.h"
#include "sim/rest_factor.h"

namespace fascia::sim {

/// Workspace of `minimise` and `newton`, allocated once.
struct MinimiseWorkspace {
  static constexpr size_t history = 10;
  Positions gradient, trial, trial_gradient;                    // by node
  Positions packed, gradient_before, gradient_packed, scratch;  // by unknown; `packed` holds directions
  std::vector<Positions> steps, changes;                        // by unknown

  MinimiseWorkspace(size_t nodes, size_t unknowns)
      : gradient(nodes),
        trial(nodes),
        trial_gradient(nodes),
        packed(unknowns),
        gradient_before(unknowns),
        gradient_packed(unknowns),
        scratch(unknowns),
        steps(history, Positions(unknowns)),
        changes(history, Positions(unknowns)) {}
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
  for (const Vec3& v : a) {
    const double squared = v.squaredNorm();
    if (!(squared <= most)) most = squared;  // also when it is not a number
  }
  return std::sqrt(most);
}

inline void add(double factor, const Positions& a, Positions& to) {
  for (size_t i = 0; i < to.size(); ++i)
    to[i] += factor * a[i];
}

/// Unknowns in double precision, for `minimise`: those of the nodes `x`, preconditioned by the rest factor.
template <class Function>
struct NodeSpace {
  static constexpr size_t history = MinimiseWorkspace::history;
  Function& function;
  const RestFactor& factor;
  const std::vector<uint32_t>& unknowns;
  MinimiseWorkspace& w;
  Positions& x;

  double evaluate() {
    const double value = function(x.data(), w.gradient.data());
    for (size_t i = 0; i < unknowns.size(); ++i)
      w.gradient_packed[i] = w.gradient[unknowns[i]];
    return value;
  }
  double residual() const { return largest(w.gradient_packed); }
  void start_direction() { w.packed = w.gradient_packed; }
  void precondition() { factor.solve(w.packed, w.scratch); }
  double step_dot(size_t slot) const { return dot(w.steps[slot], w.packed); }
  double change_dot(size_t slot) const { return dot(w.changes[slot], w.packed); }
  void add_step(double factor_, size_t slot) { add(factor_, w.steps[slot], w.packed); }
  void add_change(double factor_, size_t slot) { add(factor_, w.changes[slot], w.packed); }
  void negate() {
    for (Vec3& v : w.packed)
      v = -v;
  }
  double slope() const { return dot(w.packed, w.gradient_packed); }
  double longest() const { return largest(w.packed); }
  void go(double length) {
    for (size_t i = 0; i < unknowns.size(); ++i)
      x[unknowns[i]] += length * w.packed[i];
  }
  void keep_gradient() { std::swap(w.gradient_packed, w.gradient_before); }
  double remember(size_t slot, double length) {
    for (size_t i = 0; i < unknowns.size(); ++i) {
      w.steps[slot][i] = length * w.packed[i];
      w.changes[slot][i] = w.gradient_packed[i] - w.gradient_before[i];
    }
    return dot(w.steps[slot], w.changes[slot]);
  }
};

}  // namespace detail

/// Minimises `function(x, gradient)`, joules and newtons by node, over the nodes `unknowns` of `x` (#nodes),
/// preconditioned by the rest factor; see quasi_newton.h.
template <class Function>
MinimiseResult minimise(Function&& function, const RestFactor& factor, const std::vector<uint32_t>& unknowns,
                        const MinimiseOptions& options, MinimiseWorkspace& w, Positions& x) {
  detail::NodeSpace<std::remove_reference_t<Function>> space{function, factor, unknowns, w, x};
  return minimise(space, options, LineSearch{});
}

}  // namespace fascia::sim
