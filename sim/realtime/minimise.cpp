#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "sim/realtime/solve.h"

// How a face in real time comes to a minimum of its energies.

namespace fascia::sim::realtime {

using solving::add_at;
using solving::f;
using solving::place_at;

/// Bones, the other lip, friction and touches: few nodes, one after the other.
double Solver::contact_energy(Solve& solve, const float* x, float* gradient) {
  const Contacts& contacts = model_->face().contacts();
  double energy = 0.0;
  const Mat3 to_mandible = solve.mandible.rotation.transpose();
  for (size_t c = 0; c < reach_.size(); ++c) {
    const int32_t at = model_->slot_of(contacts.bone_nodes()[c]);
    const Vec3 place = place_at(x, at);
    const bool moves = contacts.bone_moves(c);
    const Vec3 local = moves ? Vec3(to_mandible * (place - solve.mandible.translation)) : place;
    BoneReach& reach = reach_[c];
    const Vec3 away = local - Vec3(reach.place[0], reach.place[1], reach.place[2]);
    if (reach.free >= 0.0F && away.squaredNorm() < static_cast<double>(reach.free) * reach.free) continue;
    const Contacts::Touch touch = contacts.bone_touch(c, local);
    for (int axis = 0; axis < 3; ++axis)
      reach.place[axis] = f(local[axis]);
    // Outside its grid the field says nothing: one cell's width is safe to go before looking again.
    reach.free = std::isfinite(touch.depth)
                     ? f(std::max(0.0, -touch.depth) / contacts.bone_field(c).steepness())
                     : 0.0F;
    if (!(touch.depth > 0.0)) continue;
    const double push = contacts.options().bone_stiffness * touch.depth;
    add_at(gradient, at, -push * (moves ? Vec3(solve.mandible.rotation * touch.normal) : touch.normal));
    energy += 0.5 * push * touch.depth;
    gradient[at + 3] += f(contacts.options().bone_stiffness);
  }
  const auto place_of = [&](uint32_t node) { return place_at(x, model_->slot_of(node)); };
  const auto add = [&](uint32_t node, const Vec3& force, double stiffness) {
    const int32_t at = model_->slot_of(node);
    add_at(gradient, at, force);
    gradient[at + 3] += f(stiffness);
  };
  energy += contacts.facing_energy(facing_, place_of, add);
  energy += Contacts::grip_energy(solve.grips, place_of, add);
  energy += touch_energy(solve.touches, model_->face().rest(), place_of, add);
  return energy;
}

/// Energy at `x` where it is wanted, its gradient over unknowns in `work.packed`.
double Solver::evaluate(Solve& solve, const float* x, bool wants_energy) {
  Workspace& w = solve.work;
  const Loops& loops = model_->loops();
  float* const gradient = w.gradient.data();
  const auto find = wants_energy ? loops.energy : loops.gradient;
  double energy = find(model_->packed(), solve.boundary, x, gradient);
  energy += contact_energy(solve, x, gradient);
  solve.unknowns.x = x;
  solve.unknowns.gradient = gradient;
  if (solve.unknowns.per_mass != 0.0F) {
    loops.subtract(solve.unknowns, w.moved.data());
    loops.multiply(model_->stiffness(), w.moved.data(), w.damped.data());
  }
  return energy +
         loops.collect(solve.unknowns, w.moved.data(), w.damped.data(), w.packed.data(), w.scaling.data());
}

/// Unknowns in single precision, for sim::minimise: those of the model's places `x`, preconditioned by the
/// factor, scaled where a node is stiffer than it knows.
struct Solver::Space {
  static constexpr size_t history = Workspace::history;
  Solver& face;
  Solve& solve;
  float* x;
  Workspace& w = solve.work;
  const Loops& loops = face.model_->loops();
  size_t floats = face.model_->unknown_floats();

  double evaluate() { return face.evaluate(solve, x); }
  double residual() const { return std::sqrt(static_cast<double>(loops.largest(w.packed.data(), floats))); }
  void start_direction() { std::copy(w.packed.data(), w.packed.data() + floats, w.direction.data()); }
  void precondition() { precondition(w.direction.data()); }
  /// direction := P^-1 from.
  void precondition(const float* from) {
    float* const direction = w.direction.data();
    if (solve.hessian != nullptr) return precondition_by_hessian(from, direction);
    loops.scale(w.scaling.data(), from, direction, floats);
    loops.solve(solve.factor, direction, w.solve_scratch.data());
    loops.scale(w.scaling.data(), direction, direction, floats);
  }
  void precondition_by_hessian(const float* from, float* direction) {
    const std::vector<uint32_t>& unknowns = face.model_->face().unknowns();
    PoseHessian::Dense& vector = solve.hessian->vector;
    vector.resize(static_cast<Eigen::Index>(3 * unknowns.size()), 1);
    const std::vector<uint32_t>& order = face.model_->order();
    for (size_t k = 0; k < order.size(); ++k)
      for (size_t axis = 0; axis < 3; ++axis)
        vector(static_cast<Eigen::Index>(3 * order[k] + axis), 0) = from[4 * k + axis];
    vector = solve.hessian->hessian.solve(vector);
    for (size_t k = 0; k < order.size(); ++k)
      for (size_t axis = 0; axis < 3; ++axis)
        direction[4 * k + axis] = vector(static_cast<Eigen::Index>(3 * order[k] + axis), 0);
  }
  double step_dot(size_t slot) const { return loops.dot(w.steps[slot].data(), w.direction.data(), floats); }
  double change_dot(size_t slot) const {
    return loops.dot(w.changes[slot].data(), w.direction.data(), floats);
  }
  void add_step(double factor, size_t slot) {
    loops.add(f(factor), w.steps[slot].data(), w.direction.data(), floats);
  }
  void add_change(double factor, size_t slot) {
    loops.add(f(factor), w.changes[slot].data(), w.direction.data(), floats);
  }
  void negate() { loops.add(-2.0F, w.direction.data(), w.direction.data(), floats); }
  double slope() const { return loops.dot(w.direction.data(), w.packed.data(), floats); }
  double longest() const { return std::sqrt(static_cast<double>(loops.largest(w.direction.data(), floats))); }
  void go(double length) {
    const auto& slots = face.model_->slots();
    const float* direction = w.direction.data();
    const float factor = f(length);
    for (size_t k = 0; k < slots.size(); ++k)
      for (size_t axis = 0; axis < 3; ++axis)
        x[static_cast<size_t>(slots[k]) + axis] += factor * direction[4 * k + axis];
  }
  void keep_gradient() { std::swap(w.last_gradient, w.packed); }
  double remember(size_t slot, double length) {
    float* const step = w.steps[slot].data();
    float* const change = w.changes[slot].data();
    const float *direction = w.direction.data(), *now = w.packed.data(), *before = w.last_gradient.data();
    const float factor = f(length);
    for (size_t i = 0; i < floats; ++i) {
      step[i] = factor * direction[i];
      change[i] = now[i] - before[i];
    }
    return loops.dot(step, change, floats);
  }
};

MinimiseResult Solver::minimise(Solve& solve, const MinimiseOptions& options, float* x) {
  constexpr LineSearch single_precision{16, 1e-6, 0.2};
  Space space{*this, solve, x};
  return sim::minimise(space, options, single_precision);
}

MinimiseResult Solver::iterate(Solve& solve, const MinimiseOptions& options, float* x) {
  Workspace& w = solve.work;
  Space space{*this, solve, x};
  MinimiseResult result;
  for (int iteration = 0; iteration < options.iterations; ++iteration) {
    evaluate(solve, x, false);
    space.precondition(w.packed.data());
    space.negate();
    result.move = space.longest();
    result.converged = result.move <= options.tolerance;
    if (result.converged || !std::isfinite(result.move)) return result;
    const bool is_first = iteration == 0, judges = !is_first || options.iterations == 1;
    model_->loops().take_steps({model_->slots().size(), model_->slots().data(), w.direction.data(), judges,
                                w.packed.data(), is_first ? nullptr : w.last_gradient.data(),
                                last_direction_.data(), step_scale_.data(), x});
    space.keep_gradient();
    result.iterations = iteration + 1;
  }
  return result;
}

}  // namespace fascia::sim::realtime
