#include "sim/reference_solver.h"

#include <algorithm>
#include <cmath>

#include "sim/jaw_stages.h"

namespace fascia::sim {

ReferenceSolver::ReferenceSolver(const FaceModel& model, size_t channels, const PoseOptions& pose,
                                 const StepOptions& step)
    : model_(&model),
      pose_options_(pose),
      step_options_(step),
      frame_(model.make_frame()),
      pose_frame_(frame_),
      position_(model.rest()),
      previous_(position_),
      velocity_(position_.size(), Vec3::Zero()),
      carried_(position_),
      pose_(position_),
      pose_offset_(position_.size(), Vec3::Zero()),
      start_(position_),
      work_(position_.size()),
      time_(channels),
      workspace_(position_.size(), model.unknowns().size()) {
  model.pose_factor();  // made now, so that no step allocates
  model.step_factor();
}

MinimiseResult ReferenceSolver::find_pose(const PoseOptions& options) {
  const auto energy = [this](const Vec3* x, Vec3* gradient) {
    return model_->energy(pose_frame_, x, gradient);
  };
  const auto& unknowns = model_->unknowns();
  MinimiseResult result =
      minimise(energy, model_->pose_factor(), unknowns, options.solver, workspace_, pose_);
  if (result.converged || !std::isfinite(result.residual) || options.newton.iterations <= 0) return result;
  newton_.resize(pose_.size(), unknowns.size());
  for (size_t i = 0; i < unknowns.size(); ++i)
    newton_.weights[i] = model_->stiffness().coeff(static_cast<int>(i), static_cast<int>(i));
  const auto curvature = [this](const Vec3* x, Curvature& out) {
    model_->find_curvature(pose_frame_, x, out);
  };
  const int before = result.iterations;
  result = newton(energy, curvature, model_->pose_factor(), unknowns, options.newton,
                  options.solver.tolerance, workspace_, newton_, pose_);
  result.iterations += before;
  return result;
}

MinimiseResult ReferenceSolver::static_pose(const Controls& controls, const PoseOptions& options,
                                            std::span<Vec3f> positions) {
  return pose_in_stages(controls, options, positions,
                        [this](const Controls& part, const PoseOptions& how, std::span<Vec3f> to) {
                          return pose_at_once(part, how, to);
                        });
}

MinimiseResult ReferenceSolver::pose_at_once(const Controls& controls, const PoseOptions& options,
                                             std::span<Vec3f> positions) {
  model_->place(controls, pose_frame_);
  for (size_t i = 0; i < pose_.size(); ++i) {
    pose_[i] = pose_frame_.carried[i];
    if (options.from_last_pose) pose_[i] += pose_offset_[i];
  }
  // What lips and lids face is found, held during a solve, and found again until it no longer matters.
  MinimiseResult result;
  model_->find_facing(pose_.data(), pose_frame_);
  for (int round = 0; round < options.contact_rounds; ++round) {
    const int before = result.iterations;
    result = find_pose(options);
    result.iterations += before;
    if (model_->find_facing(pose_.data(), pose_frame_) < options.contact_tolerance) break;
  }
  for (size_t i = 0; i < pose_.size(); ++i) {
    pose_offset_[i] = pose_[i] - pose_frame_.carried[i];
    if (i < positions.size())
      positions[i] = model_->lattice().rest[i] + (pose_[i] - model_->rest()[i]).cast<float>();
  }
  return result;
}

void ReferenceSolver::reset(const Controls& controls) {
  model_->place({{}, controls.jaw, Vec3::Zero()}, frame_);
  position_ = frame_.carried;
  previous_ = position_;
  carried_ = frame_.carried;
  std::fill(velocity_.begin(), velocity_.end(), Vec3::Zero());
  time_.reset(controls);
}

MinimiseResult ReferenceSolver::settle(const Controls& controls, const PoseOptions& options) {
  const MinimiseResult result = static_pose(controls, options, {});
  reset(controls);
  time_.settle(controls);
  position_ = pose_;
  previous_ = pose_;
  model_->place({time_.activations(), time_.jaw(), time_.acceleration()}, frame_);
  return result;
}

MinimiseResult ReferenceSolver::substep(const Controls& now, const StepOptions& options) {
  const double h = model_->options().substep;
  carried_ = frame_.carried;
  const RigidTransform mandible = frame_.mandible;
  model_->place(now, frame_);
  model_->find_facing(position_.data(), frame_);
  RigidTransform mandible_step;
  mandible_step.rotation = frame_.mandible.rotation * mandible.rotation.transpose();
  mandible_step.translation = frame_.mandible.translation - mandible_step.rotation * mandible.translation;
  frame_.grip_count = model_->contacts().find_grips(mandible, mandible_step, frame_.facing, previous_.data(),
                                                    position_.data(), frame_.grips);

  // Damping acts on motion relative to the bones, so that the jaw carries its tissue along undamped.
  previous_ = position_;
  for (size_t i = 0; i < position_.size(); ++i) {
    start_[i] = position_[i] + h * velocity_[i];
    carried_[i] = position_[i] + (frame_.carried[i] - carried_[i]);  // where the bones alone would bring it
    if (model_->prescribed(i)) carried_[i] = frame_.carried[i];
    position_[i] = carried_[i];
  }
  const double stiff = model_->options().stiffness_damping / h, drag = model_->options().mass_damping / h;
  const auto& unknowns = model_->unknowns();
  const auto& masses = model_->masses();
  const auto& matrix = model_->stiffness();
  const auto potential = [&](const Vec3* x, Vec3* gradient) {
    double value = model_->energy(frame_, x, gradient);
    for (size_t i = 0; i < unknowns.size(); ++i) {
      const uint32_t node = unknowns[i];
      const Vec3 ballistic = x[node] - start_[node], moved = x[node] - carried_[node];
      Vec3 force = masses[node] * drag * moved;
      for (Eigen::SparseMatrix<double, Eigen::RowMajor>::InnerIterator e(matrix, static_cast<int>(i)); e;
           ++e) {
        const uint32_t other = unknowns[static_cast<size_t>(e.col())];
        force += (stiff * e.value()) * (x[other] - carried_[other]);
      }
      const double inertia = masses[node] / (h * h);
      value += 0.5 * inertia * ballistic.squaredNorm() + 0.5 * force.dot(moved);
      gradient[node] += inertia * ballistic + force;
    }
    return value;
  };
  const MinimiseResult result =
      minimise(potential, model_->step_factor(), unknowns, options.solver, workspace_, position_);
  frame_.grip_count = 0;
  for (size_t i = 0; i < position_.size(); ++i)
    velocity_[i] = (position_[i] - previous_[i]) / h;
  return result;
}

bool ReferenceSolver::sound(const StepOptions& options) const {
  for (size_t i = 0; i < position_.size(); ++i) {
    const double away = (position_[i] - frame_.carried[i]).norm();
    if (!(away <= options.largest_displacement)) return false;  // also when it is not a number
  }
  return true;
}

StepResult ReferenceSolver::step(double seconds, const Controls& controls, const StepOptions& options) {
  const auto solve = [&](const Controls& now, MinimiseResult& solved) {
    solved = substep(now, options);
    return sound(options);
  };
  const StepResult result = time_.run(seconds, controls, model_->options().substep,
                                      options.largest_number_of_substeps, model_->options().dynamics, solve);
  if (result.status == StepStatus::reset) reset(controls);
  return result;
}

void ReferenceSolver::displacements(std::span<Vec3f> out) const {
  const double back = time_.back();
  for (size_t i = 0; i < out.size() && i < position_.size(); ++i)
    out[i] = (position_[i] - model_->rest()[i] + back * (previous_[i] - position_[i])).cast<float>();
}

void ReferenceSolver::positions(std::span<Vec3f> out) const {
  displacements(out);
  for (size_t i = 0; i < out.size() && i < position_.size(); ++i)
    out[i] += model_->lattice().rest[i];
}

bool ReferenceSolver::exchange_state(StateBytes& bytes) {
  for (Positions* list : {&position_, &previous_, &velocity_, &frame_.carried})
    bytes.list(list->data(), list->size());
  bytes.list(frame_.facing.data(), frame_.facing.size());
  bytes.value(frame_.mandible);
  if (!time_.exchange_state(bytes) || bytes.is_short()) return false;
  return std::all_of(frame_.facing.begin(), frame_.facing.end(),
                     [this](const FacingPair& pair) { return pair.fits(position_.size()); });
}

double ReferenceSolver::total_energy() {
  double energy = model_->energy(frame_, position_.data(), work_.data());
  for (const uint32_t i : model_->unknowns())
    energy += 0.5 * model_->masses()[i] * velocity_[i].squaredNorm();
  return energy;
}

}  // namespace fascia::sim
