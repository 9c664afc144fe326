#include "sim/realtime/face.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace fascia::sim::realtime {
namespace {

/// Fields of distances rise by at most this much a metre: one, but for their grid.
constexpr double steepest = 1.25;

float f(double value) {
  return static_cast<float>(value);
}
Vec3 place_at(const float* list, int32_t at) {
  return {list[at], list[at + 1], list[at + 2]};
}
void add_at(float* list, int32_t at, const Vec3& value) {
  for (int axis = 0; axis < 3; ++axis)
    list[at + axis] += f(value[axis]);
}

}  // namespace

/// One minimisation: what stands still while it runs.
struct Face::Solve {
  Workspace& work;
  Driven driven;
  Panels factor;
  RigidTransform mandible;
  std::span<const NodeForce> touches;
  Unknowns unknowns{};
  std::span<const Grip> grips;
};

Face::Face(const Model& model, size_t channels)
    : model_(&model),
      position_(model.places()),
      velocity_(model.places()),
      carried_(model.places()),
      last_direction_(model.unknown_floats()),
      trust_(model.unknown_floats() / 4),
      facing_(model.face().contacts().facing_count()),
      reach_(model.face().contacts().bone_nodes().size()),
      excitations_(channels),
      last_excitations_(channels),
      activations_(channels) {
  reset({});
}

void Face::place(const JawPose& jaw, std::span<const float> activations, Workspace& work,
                 Driven& driven) const {
  driven = model_->driven(work);
  for (size_t c = 0; c < work.values.size() && c < activations.size(); ++c)
    work.values[c] = std::isfinite(activations[c]) ? activations[c] : 0.0F;
  model_->set_jaw(jaw, driven);
  model_->loops().place(model_->packed(), driven);
}

void Face::fill_nodes(const float* x, Positions& nodes) const {
  for (size_t i = 0; i < nodes.size(); ++i)
    nodes[i] = place_at(x, model_->slot_of(i));
}

/// Bones, the other lip, friction and touches: few nodes, one after the other.
double Face::contact_energy(Solve& solve, const float* x, float* gradient) {
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
    Vec3 slope;
    const double depth = contacts.bone_margins()[c] - contacts.bone_field(c).sample(local, slope);
    for (int axis = 0; axis < 3; ++axis)
      reach.place[axis] = f(local[axis]);
    // Outside its grid the field says nothing: one cell's width is safe to go before looking again.
    reach.free = std::isfinite(depth) ? f(std::max(0.0, -depth) / steepest) : 0.0F;
    if (!(depth > 0.0)) continue;
    const double push = contacts.options().bone_stiffness * depth;
    add_at(gradient, at, -push * (moves ? Vec3(solve.mandible.rotation * slope) : slope));
    energy += 0.5 * push * depth;
    gradient[at + 3] += f(contacts.options().bone_stiffness);
  }
  for (const FacingPair& pair : facing_) {
    if (!pair.is_found()) continue;
    Vec3 gap = place_at(x, model_->slot_of(pair.node));
    for (size_t k = 0; k < 3; ++k)
      gap -= pair.weights[static_cast<int>(k)] * place_at(x, model_->slot_of(pair.corners[k]));
    const double depth = pair.margin - pair.normal.dot(gap);
    if (depth <= 0.0) continue;
    const Vec3 push = (contacts.options().facing_stiffness * depth) * pair.normal;
    const auto stiffer = f(2.0 * contacts.options().facing_stiffness);
    gradient[model_->slot_of(pair.node) + 3] += stiffer;
    for (size_t k = 0; k < 3; ++k)
      gradient[model_->slot_of(pair.corners[k]) + 3] += f(pair.weights[static_cast<int>(k)]) * stiffer;
    energy += 0.5 * contacts.options().facing_stiffness * depth * depth;
    add_at(gradient, model_->slot_of(pair.node), -push);
    for (size_t k = 0; k < 3; ++k)
      add_at(gradient, model_->slot_of(pair.corners[k]), pair.weights[static_cast<int>(k)] * push);
  }
  for (const Grip& grip : solve.grips) {
    Vec3 slip = place_at(x, model_->slot_of(grip.node)) - grip.anchor;
    const bool facing = grip.corners[0] != FacingPair::none;
    for (size_t k = 0; facing && k < 3; ++k)
      slip -= grip.weights[static_cast<int>(k)] * place_at(x, model_->slot_of(grip.corners[k]));
    const double along = grip.normal.dot(slip);
    const Vec3 force =
        grip.stiffness * (slip - along * grip.normal) + (grip.normal_stiffness * along) * grip.normal;
    energy += 0.5 * force.dot(slip);
    add_at(gradient, model_->slot_of(grip.node), force);
    gradient[model_->slot_of(grip.node) + 3] += f(grip.stiffness + grip.normal_stiffness);
    for (size_t k = 0; facing && k < 3; ++k)
      add_at(gradient, model_->slot_of(grip.corners[k]), -grip.weights[static_cast<int>(k)] * force);
  }
  const Positions& rest = model_->face().rest();
  for (const NodeForce& touch : solve.touches) {
    if (touch.node >= rest.size() || !touch.force.allFinite()) continue;
    const int32_t at = model_->slot_of(touch.node);
    add_at(gradient, at, -touch.force);
    energy -= touch.force.dot(place_at(x, at) - rest[touch.node]);
  }
  return energy;
}

/// Energy at `x`, its gradient over unknowns in `work.packed`.
double Face::evaluate(Solve& solve, const float* x) {
  Workspace& w = solve.work;
  const Loops& loops = model_->loops();
  float* const gradient = w.gradient.data();
  double energy = loops.energy(model_->packed(), solve.driven, x, gradient);
  energy += contact_energy(solve, x, gradient);
  solve.unknowns.x = x;
  solve.unknowns.gradient = gradient;
  if (solve.unknowns.per_mass != 0.0F) {
    loops.subtract(solve.unknowns, w.moved.data());
    loops.multiply(model_->stiffness(), w.moved.data(), w.damped.data());
  }
  return energy +
         loops.collect(solve.unknowns, w.moved.data(), w.damped.data(), w.packed.data(), w.answer.data());
}

/// What is left to go along the stride before, by what it did to the gradient: the line search along it that
/// was left out, finished, and what keeps the new direction from undoing it (Hestenes & Stiefel 1952). The
/// preconditioner answers for x, y and z alike and so goes too short; nobody looks where this leads, so no
/// more than once as far.
float Face::left_to_go(const Workspace& w) const {
  const size_t floats = model_->unknown_floats();
  const auto dot = model_->loops().dot;
  const float *stride = w.steps[0].data(), *before = w.last_gradient.data(), *now = w.packed.data(),
              *direction = w.direction.data();
  const double slope = dot(stride, now, floats), curvature = slope - dot(stride, before, floats);
  const double answer = dot(direction, before, floats) - dot(direction, now, floats);
  return curvature > 0.0 ? f(std::clamp((answer - slope) / curvature, 0.0, 1.0)) : 0.0F;
}

/// As sim::minimise: quasi-Newton steps on the rest factor, with the last few changes of the gradient as
/// corrections.
MinimiseResult Face::minimise(Solve& solve, const MinimiseOptions& options, bool checks_last, float* x) {
  constexpr size_t history = Workspace::history;
  const Loops& loops = model_->loops();
  Workspace& w = solve.work;
  const size_t floats = model_->unknown_floats();
  const auto& slots = model_->slots();
  const auto go = [&](float length) {
    const float* direction = w.direction.data();
    for (size_t k = 0; k < slots.size(); ++k)
      for (size_t axis = 0; axis < 3; ++axis)
        x[static_cast<size_t>(slots[k]) + axis] += length * direction[4 * k + axis];
  };
  MinimiseResult result;
  double curvatures[history] = {};
  size_t first = 0, count = 0;
  double value = evaluate(solve, x);
  for (int iteration = 0;; ++iteration) {
    result.iterations = iteration;
    result.residual = std::sqrt(static_cast<double>(loops.largest(w.packed.data(), floats)));
    if (!std::isfinite(value) || !std::isfinite(result.residual)) return result;
    // direction := -H gradient (Nocedal & Wright 2006, algorithm 7.4)
    float* const direction = w.direction.data();
    std::copy(w.packed.data(), w.packed.data() + floats, direction);
    double share[history] = {};
    for (size_t k = count; k-- > 0;) {
      const size_t slot = (first + k) % history;
      share[k] = loops.dot(w.steps[slot].data(), direction, floats) / curvatures[slot];
      loops.add(f(-share[k]), w.changes[slot].data(), direction, floats);
    }
    loops.scale(w.answer.data(), direction, floats);
    loops.solve(solve.factor, direction, w.solve_scratch.data());
    loops.scale(w.answer.data(), direction, floats);
    for (size_t k = 0; k < count; ++k) {
      const size_t slot = (first + k) % history;
      const double back = share[k] - loops.dot(w.changes[slot].data(), direction, floats) / curvatures[slot];
      loops.add(f(back), w.steps[slot].data(), direction, floats);
    }
    loops.add(-2.0F, direction, direction, floats);
    result.move = std::sqrt(static_cast<double>(loops.largest(direction, floats)));
    if (result.move <= options.tolerance) {
      result.converged = true;
      return result;
    }
    if (iteration >= options.iterations) return result;
    const double slope = loops.dot(direction, w.packed.data(), floats);
    if (!(slope < 0.0)) {
      if (count == 0) return result;
      count = 0;
      continue;
    }
    float length = f(std::min(1.0, 0.02 / result.move));
    if (!checks_last) {
      float* const before = w.steps[0].data();
      loops.stride({slots.size(), slots.data(), direction, before, iteration > 0 ? left_to_go(w) : 0.0F,
                    last_direction_.data(), trust_.data(), x});
      if (iteration + 1 >= options.iterations) {
        result.iterations = iteration + 1;
        return result;
      }
      std::copy(direction, direction + floats, before);
      std::swap(w.last_gradient, w.packed);
      value = evaluate(solve, x);
      continue;
    }
    go(length);
    std::swap(w.last_gradient, w.packed);
    double trial = 0.0;
    bool fell = false;
    for (int halving = 0; halving < 16; ++halving) {
      trial = evaluate(solve, x);
      // Where energies differ by less than their rounding, the slope tells (Hager & Zhang 2005, approximate
      // Wolfe conditions).
      fell = trial <= value + 1e-4 * length * slope ||
             (trial <= value + 1e-6 * std::abs(value) &&
              std::abs(loops.dot(direction, w.packed.data(), floats)) <= 0.9 * std::abs(slope));
      if (fell) break;
      go(-0.5F * length);
      length *= 0.5F;
    }
    if (!fell) {
      go(-length);
      std::swap(w.last_gradient, w.packed);
      if (count == 0) return result;
      count = 0;
      continue;
    }
    const size_t slot = (first + count) % history;
    float* const step = w.steps[slot].data();
    float* const change = w.changes[slot].data();
    const float* before = w.last_gradient.data();
    for (size_t i = 0; i < floats; ++i) {
      step[i] = length * direction[i];
      change[i] = w.packed.data()[i] - before[i];
    }
    const double curvature = loops.dot(step, change, floats);
    if (curvature > 0.2 * length * std::abs(slope)) {
      curvatures[slot] = curvature;
      if (count < history)
        ++count;
      else
        first = (first + 1) % history;
    }
    value = trial;
  }
}

MinimiseResult Face::static_pose(const Drive& drive, const PoseOptions& options, std::span<Vec3f> positions) {
  std::unique_ptr<Workspace> work = model_->borrow();
  const JawPose jaw = clamped(drive.jaw);
  Solve solve{*work,
              {},
              model_->pose_factor(),
              jaw_transform(model_->face().jaw(), jaw),
              drive.touches,
              model_->unknown_list(),
              {}};
  solve.unknowns.diagonal = model_->pose_diagonal();
  for (int axis = 0; axis < 3; ++axis)
    solve.unknowns.acceleration[axis] = drive.acceleration.allFinite() ? f(drive.acceleration[axis]) : 0.0F;
  place(jaw, drive.activations, *work, solve.driven);
  float* const x = work->start.data();
  std::copy(work->carried.data(), work->carried.data() + model_->places(), x);
  if (options.from_last_pose && pose_offset_.size() > 0)
    model_->loops().add(1.0F, pose_offset_.data(), x, model_->places());
  const Contacts& contacts = model_->face().contacts();
  fill_nodes(x, work->nodes);
  contacts.find_facing(work->nodes.data(), facing_, work->facing_search);
  MinimiseResult result;
  for (int round = 0; round < options.contact_rounds; ++round) {
    const int before = result.iterations;
    result = minimise(solve, options.solver, true, x);
    result.iterations += before;
    if (facing_.empty()) break;
    fill_nodes(x, work->nodes);
    if (contacts.find_facing(work->nodes.data(), facing_, work->facing_search) < options.contact_tolerance)
      break;
  }
  if (pose_offset_.size() == 0) pose_offset_ = Floats(model_->places());
  for (size_t i = 0; i < model_->places(); ++i)
    pose_offset_.data()[i] = x[i] - work->carried.data()[i];
  for (size_t i = 0; i < positions.size() && i < model_->face().rest().size(); ++i)
    positions[i] = place_at(x, model_->slot_of(i)).cast<float>();
  model_->give_back(std::move(work));
  return result;
}

void Face::reset(const Drive& drive) {
  std::unique_ptr<Workspace> work = model_->borrow();
  last_jaw_ = clamped(drive.jaw);
  Driven driven{};
  place(last_jaw_, {}, *work, driven);
  std::copy(work->carried.data(), work->carried.data() + model_->places(), position_.data());
  std::copy(work->carried.data(), work->carried.data() + model_->places(), carried_.data());
  std::fill(velocity_.data(), velocity_.data() + velocity_.size(), 0.0F);
  std::fill(last_direction_.data(), last_direction_.data() + last_direction_.size(), 0.0F);
  std::fill(trust_.data(), trust_.data() + trust_.size(), 1.0F);
  std::fill(activations_.begin(), activations_.end(), 0.0F);
  std::fill(last_excitations_.begin(), last_excitations_.end(), 0.0F);
  last_mandible_ = jaw_transform(model_->face().jaw(), last_jaw_);
  last_acceleration_.setZero();
  left_over_ = 0.0;
  turn_ = 0;
  model_->give_back(std::move(work));
}

MinimiseResult Face::settle(const Drive& drive, const PoseOptions& options) {
  const MinimiseResult result = static_pose(drive, options, {});
  reset(drive);
  for (size_t c = 0; c < activations_.size(); ++c)
    activations_[c] = drive.activation(c);
  last_excitations_ = activations_;
  last_acceleration_ = drive.acceleration;
  model_->loops().add(1.0F, pose_offset_.data(), position_.data(), model_->places());
  return result;
}

MinimiseResult Face::substep(double share, const Drive& drive, const StepOptions& options, Workspace& work) {
  const FaceModel& face = model_->face();
  const double h = face.options().substep;
  for (size_t c = 0; c < excitations_.size(); ++c) {
    const float goal = c < drive.activations.size() ? drive.activations[c] : 0.0F;
    excitations_[c] = last_excitations_[c] + f(share) * (goal - last_excitations_[c]);
  }
  follow(options.dynamics, h, excitations_, activations_);
  const auto mix = [share](float from, float to) { return from + f(share) * (to - from); };
  const JawPose goal = clamped(drive.jaw);
  const JawPose jaw{mix(last_jaw_.open, goal.open), mix(last_jaw_.forward, goal.forward),
                    mix(last_jaw_.lateral, goal.lateral)};
  Solve solve{
      work, {}, model_->step_factor(), jaw_transform(face.jaw(), jaw), drive.touches, model_->unknown_list(),
      {}};
  const Vec3 acceleration = last_acceleration_ + share * (drive.acceleration - last_acceleration_);
  for (int axis = 0; axis < 3; ++axis)
    solve.unknowns.acceleration[axis] = f(acceleration[axis]);
  place(jaw, activations_, work, solve.driven);

  const Contacts& contacts = face.contacts();
  float* const x = position_.data();
  float* const velocity = velocity_.data();
  if (!facing_.empty() || !reach_.empty()) {
    // Only what may touch is looked at.
    const auto bring = [&](uint32_t node) {
      const int32_t at = model_->slot_of(node);
      work.nodes[node] = place_at(x, at);
      work.nodes_before[node] = work.nodes[node] - h * place_at(velocity, at);
    };
    for (const uint32_t node : contacts.soft_nodes())
      bring(node);
    // Who faces whom changes slowly, and is known from afar: after the first time, a quarter of them a
    // substep.
    if (turn_ == 0)
      contacts.find_facing(work.nodes.data(), facing_, work.facing_search);
    else
      contacts.find_facing(work.nodes.data(), facing_, work.facing_search, turn_ % 4, 4);
    ++turn_;
    if (contacts.options().friction > 0.0 || contacts.options().stickiness > 0.0) {
      RigidTransform turn;
      turn.rotation = solve.mandible.rotation * last_mandible_.rotation.transpose();
      turn.translation = solve.mandible.translation - turn.rotation * last_mandible_.translation;
      work.grips.resize(contacts.grip_capacity());
      work.near_bones.clear();
      for (uint32_t c = 0; c < reach_.size(); ++c)
        if (!(reach_[c].free > 0.0F)) {
          work.near_bones.push_back(c);
          bring(contacts.bone_nodes()[c]);
        }
      const size_t grips = contacts.find_grips(last_mandible_, turn, facing_, work.nodes_before.data(),
                                               work.nodes.data(), work.grips, &work.near_bones);
      solve.grips = std::span(work.grips).first(grips);
    }
  }
  last_mandible_ = solve.mandible;
  solve.unknowns.diagonal = model_->step_diagonal();
  solve.unknowns.ballistic = work.ballistic.data();
  solve.unknowns.begun = work.begun.data();
  solve.unknowns.per_mass = f(1.0 / (h * h));
  solve.unknowns.drag = f(face.options().mass_damping / h);
  solve.unknowns.stiff = f(face.options().stiffness_damping / h);
  // Damping acts on motion relative to the bones, so that the jaw carries its tissue along undamped.
  const float* carried = work.carried.data();
  float* const before = work.start.data();
  std::copy(x, x + model_->places(), before);
  std::copy(carried, carried + model_->places(), work.begun_places.data());
  const auto& slots = model_->slots();
  const float seconds = f(h);
  model_->loops().set_out({slots.size(), slots.data(), velocity, carried, carried_.data(), trust_.data(),
                           seconds, x, work.ballistic.data(), work.begun.data(), work.begun_places.data()});
  for (const int32_t at : model_->prescribed_slots())
    std::copy(carried + at, carried + at + 4, x + at);
  std::copy(carried, carried + model_->places(), carried_.data());
  const MinimiseResult result =
      minimise(solve, {options.iterations, options.tolerance}, options.checks_last, x);
  for (int more = 0; !turn_back(work, x) && more < 4; ++more)
    minimise(solve, {2, options.tolerance}, false, x);
  for (size_t i = 0; i < model_->places(); ++i)
    velocity[i] = (x[i] - before[i]) / seconds;
  return result;
}

bool Face::sound(const float* carried, double largest) const {
  const auto most = f(largest * largest);
  for (const int32_t at : model_->slots()) {
    float squared = 0.0F;
    for (int32_t axis = 0; axis < 3; ++axis) {
      const float off = position_.data()[at + axis] - carried[at + axis];
      squared += off * off;
    }
    if (!(squared <= most)) return false;  // also when it is not a number
  }
  return true;
}

StepResult Face::step(double seconds, const Drive& drive, const StepOptions& options) {
  StepResult result;
  if (!std::isfinite(seconds) || !drive.is_finite(activations_.size())) {
    reset({{}, drive.jaw, Vec3::Zero()});
    result.status = StepStatus::reset;
    return result;
  }
  if (seconds <= 0.0) return result;
  std::unique_ptr<Workspace> work = model_->borrow();
  const double h = model_->face().options().substep, due = left_over_ + seconds;
  const int substeps = std::min(static_cast<int>(due / h + 1e-9), options.largest_number_of_substeps);
  for (int k = 0; k < substeps && result.status == StepStatus::done; ++k) {
    // The drive at this substep's own time: before it lie last frame's left-over and k whole substeps.
    const MinimiseResult solved =
        substep(std::clamp(((k + 1) * h - left_over_) / seconds, 0.0, 1.0), drive, options, *work);
    ++result.substeps;
    result.iterations += solved.iterations;
    result.move = solved.move;
    if (!sound(carried_.data(), options.largest_displacement)) result.status = StepStatus::reset;
  }
  model_->give_back(std::move(work));
  if (result.status == StepStatus::reset) {
    reset(drive);
    return result;
  }
  left_over_ = std::clamp(due - substeps * h, 0.0, h);
  for (size_t c = 0; c < last_excitations_.size(); ++c)
    last_excitations_[c] = drive.activation(c);
  last_jaw_ = clamped(drive.jaw);
  last_acceleration_ = drive.acceleration;
  return result;
}

void Face::displacements(std::span<Vec3f> out) const {
  const float *x = position_.data(), *velocity = velocity_.data(), *rest = model_->packed().rest,
              coast = f(left_over_);
  for (size_t i = 0; i < out.size() && i < model_->face().rest().size(); ++i) {
    const auto at = static_cast<size_t>(model_->slot_of(i));
    for (size_t axis = 0; axis < 3; ++axis)
      out[i][static_cast<int>(axis)] = x[at + axis] - rest[at + axis] + coast * velocity[at + axis];
  }
}

void Face::positions(std::span<Vec3f> out) const {
  displacements(out);
  for (size_t i = 0; i < out.size() && i < model_->face().rest().size(); ++i)
    out[i] += model_->face().lattice().rest[i];
}

size_t Face::memory() const {
  return sizeof *this +
         sizeof(float) * (position_.size() + velocity_.size() + carried_.size() + last_direction_.size() +
                          trust_.size() + pose_offset_.size() + 3 * activations_.size()) +
         sizeof(FacingPair) * facing_.size() + sizeof(BoneReach) * reach_.size();
}

}  // namespace fascia::sim::realtime
