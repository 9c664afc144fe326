#include "sim/realtime/solver.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "sim/realtime/solve.h"

namespace fascia::sim::realtime {
using solving::f;
using solving::place_at;

namespace {

/// From so many iterations a substep on each is searched along: without, the mouth's corners do not converge.
constexpr int least_iterations_searched = 8;
/// Metres: where a substep's last iteration still wants to move a node that far, some are searched along
/// after it, in one substep a frame, so that the longest frame takes some twice the usual one.
constexpr double far_from_settled = 3e-4;
constexpr int iterations_searched = 3, searches_a_frame = 1;

}  // namespace

Solver::Solver(const Model& model, size_t channels, const PoseOptions& pose, const StepOptions& step)
    : model_(&model),
      pose_options_(pose),
      step_options_(step),
      position_(model.places()),
      velocity_(model.places()),
      carried_(model.places()),
      before_(model.places()),
      last_direction_(model.unknown_floats()),
      step_scale_(model.unknown_floats() / 4),
      facing_(model.face().contacts().facing_count()),
      reach_(model.face().contacts().bone_nodes().size()),
      time_(channels) {
  reset({});
}

void Solver::place(const JawPose& jaw, std::span<const float> activations, Workspace& work,
                   Boundary& boundary) const {
  boundary = model_->boundary(work);
  for (size_t c = 0; c < work.values.size() && c < activations.size(); ++c)
    work.values[c] = std::isfinite(activations[c]) ? activations[c] : 0.0F;
  model_->set_jaw(jaw, boundary);
  model_->loops().place(model_->packed(), boundary);
}

void Solver::fill_nodes(const float* x, Positions& nodes) const {
  for (size_t i = 0; i < nodes.size(); ++i)
    nodes[i] = place_at(x, model_->slot_of(i));
}

void Solver::reset(const Controls& controls) {
  std::unique_ptr<Workspace> work = model_->borrow();
  time_.reset(controls);
  Boundary boundary{};
  place(time_.jaw(), {}, *work, boundary);
  std::copy(work->carried.data(), work->carried.data() + model_->places(), position_.data());
  std::copy(work->carried.data(), work->carried.data() + model_->places(), carried_.data());
  std::copy(work->carried.data(), work->carried.data() + model_->places(), before_.data());
  std::fill(velocity_.data(), velocity_.data() + velocity_.size(), 0.0F);
  std::fill(last_direction_.data(), last_direction_.data() + last_direction_.size(), 0.0F);
  std::fill(step_scale_.data(), step_scale_.data() + step_scale_.size(), 1.0F);
  last_mandible_ = jaw_transform(model_->face().jaw(), time_.jaw());
  turn_ = 0;
  model_->give_back(std::move(work));
}

MinimiseResult Solver::settle(const Controls& controls, const PoseOptions& options) {
  const MinimiseResult result = static_pose(controls, options, {});
  reset(controls);
  time_.settle(controls);
  model_->loops().add(1.0F, pose_offset_.data(), position_.data(), model_->places());
  return result;
}

MinimiseResult Solver::substep(const Controls& now, const StepOptions& options, int& searches_left,
                               Workspace& work) {
  const FaceModel& face = model_->face();
  const double h = face.options().substep;
  Solve solve{work,
              {},
              model_->step_factor(),
              jaw_transform(face.jaw(), now.jaw),
              now.touches,
              model_->unknown_list(),
              {}};
  for (int axis = 0; axis < 3; ++axis)
    solve.unknowns.acceleration[axis] = f(now.acceleration[axis]);
  place(now.jaw, now.activations, work, solve.boundary);

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
    // Who faces whom changes slowly, and is known from afar: after the first time, an eighth of them a
    // substep.
    if (turn_ == 0)
      contacts.find_facing(work.nodes.data(), facing_, work.facing_search);
    else
      contacts.find_facing(work.nodes.data(), facing_, work.facing_search, turn_ % 8, 8);
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
  model_->loops().begin_step({slots.size(), slots.data(), velocity, carried, carried_.data(),
                              step_scale_.data(), seconds, x, work.ballistic.data(), work.begun.data(),
                              work.begun_places.data()});
  for (const int32_t at : model_->prescribed_slots())
    std::copy(carried + at, carried + at + 4, x + at);
  std::copy(carried, carried + model_->places(), carried_.data());
  const MinimiseOptions wanted{options.iterations, options.tolerance};
  const bool searches = options.checks_last || options.iterations >= least_iterations_searched;
  MinimiseResult result = searches ? minimise(solve, wanted, x) : iterate(solve, wanted, x);
  if (!searches && options.iterations > 1 && result.move > far_from_settled && searches_left > 0) {
    --searches_left;
    const int before_search = result.iterations;
    result = minimise(solve, {iterations_searched, options.tolerance}, x);
    result.iterations += before_search;
  }
  for (int more = 0; !untangle(work, x) && more < 4; ++more)
    iterate(solve, {2, options.tolerance}, x);
  for (size_t i = 0; i < model_->places(); ++i)
    velocity[i] = (x[i] - before[i]) / seconds;
  return result;
}

bool Solver::sound(const float* carried, double largest) const {
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

StepResult Solver::step(double seconds, const Controls& controls, const StepOptions& options) {
  int searches_left = searches_a_frame;
  std::unique_ptr<Workspace> work;
  const auto solve = [&](const Controls& now, MinimiseResult& solved) {
    if (!work) work = model_->borrow();
    solved = substep(now, options, searches_left, *work);
    return sound(carried_.data(), options.largest_displacement);
  };
  const StepResult result =
      time_.run(seconds, controls, model_->face().options().substep, options.largest_number_of_substeps,
                model_->face().options().dynamics, solve);
  if (work) {
    std::copy(work->start.data(), work->start.data() + model_->places(), before_.data());
    model_->give_back(std::move(work));
  }
  if (result.status == StepStatus::reset) reset(controls);
  return result;
}

void Solver::displacements(std::span<Vec3f> out) const {
  const float *x = position_.data(), *before = before_.data(), *rest = model_->packed().rest,
              back = f(time_.back());
  for (size_t i = 0; i < out.size() && i < model_->face().rest().size(); ++i) {
    const auto at = static_cast<size_t>(model_->slot_of(i));
    for (size_t axis = 0; axis < 3; ++axis)
      out[i][static_cast<int>(axis)] =
          x[at + axis] - rest[at + axis] + back * (before[at + axis] - x[at + axis]);
  }
}

void Solver::positions(std::span<Vec3f> out) const {
  displacements(out);
  for (size_t i = 0; i < out.size() && i < model_->face().rest().size(); ++i)
    out[i] += model_->face().lattice().rest[i];
}

bool Solver::exchange_state(StateBytes& bytes) {
  for (Floats* list : {&position_, &velocity_, &carried_, &before_, &last_direction_, &step_scale_})
    bytes.list(list->data(), list->size());
  bytes.list(facing_.data(), facing_.size());
  bytes.list(reach_.data(), reach_.size());
  bytes.value(last_mandible_);
  bytes.value(turn_);
  if (!time_.exchange_state(bytes) || bytes.is_short()) return false;
  return std::all_of(facing_.begin(), facing_.end(),
                     [this](const FacingPair& pair) { return pair.fits(model_->face().rest().size()); });
}

size_t Solver::memory() const {
  return sizeof *this +
         sizeof(float) * (position_.size() + velocity_.size() + carried_.size() + before_.size() +
                          last_direction_.size() + step_scale_.size() + pose_offset_.size()) +
         time_.bytes() + sizeof(FacingPair) * facing_.size() + sizeof(BoneReach) * reach_.size();
}

}  // namespace fascia::sim::realtime
