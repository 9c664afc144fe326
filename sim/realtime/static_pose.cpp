#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <new>

#include "sim/jaw_stages.h"
#include "sim/realtime/solve.h"

// Static poses in real time.

namespace fascia::sim::realtime {

using solving::f;
using solving::place_at;

namespace {

/// Quasi-Newton iterations from one Hessian, before it is computed again where they have led.
constexpr int iterations_a_hessian = 15;

}  // namespace

/// Quasi-Newton iterations from the factor at rest. Where they do not converge (contact and folds many times
/// stiffer than at rest), from Hessians at the pose: each costs as much as some two hundred iterations, but a
/// dozen are enough.
MinimiseResult Solver::find_equilibrium(Solve& solve, const Controls& controls, const PoseOptions& options,
                                        float* x) {
  MinimiseResult result = minimise(solve, options.solver, x);
  if (result.converged || options.newton.iterations <= 0 || !std::isfinite(result.residual)) return result;
  try {
    const FaceModel& face = model_->face();
    HessianPreconditioner preconditioner{PoseHessian(face), {}};
    Frame frame = face.make_frame();
    face.place(controls, frame);
    MinimiseOptions part = options.solver;
    part.iterations = iterations_a_hessian;
    for (int k = 0; k < options.newton.iterations && !result.converged; ++k) {
      fill_nodes(x, solve.work.nodes);
      frame.facing = facing_;
      if (!preconditioner.hessian.compute(frame, solve.work.nodes.data())) break;
      solve.hessian = &preconditioner;
      const int before = result.iterations;
      result = minimise(solve, part, x);
      result.iterations += before;
    }
  } catch (const std::bad_alloc&) {  // the quasi-Newton iterations' pose has to do
  }
  solve.hessian = nullptr;
  return result;
}

MinimiseResult Solver::static_pose(const Controls& controls, const PoseOptions& options,
                                   std::span<Vec3f> positions) {
  return pose_in_stages(controls, options, positions,
                        [this](const Controls& part, const PoseOptions& how, std::span<Vec3f> to) {
                          return pose_at_once(part, how, to);
                        });
}

void Solver::continue_from(const Solver& other) {
  if (other.pose_offset_.size() >= model_->places()) pose_offset_ = other.pose_offset_;
}

MinimiseResult Solver::pose_at_once(const Controls& controls, const PoseOptions& options,
                                    std::span<Vec3f> positions) {
  std::unique_ptr<Workspace> work = model_->borrow();
  const JawPose jaw = clamped(controls.jaw);
  Solve solve{*work,
              {},
              model_->pose_factor(),
              jaw_transform(model_->face().jaw(), jaw),
              controls.touches,
              model_->unknown_list(),
              {}};
  solve.unknowns.diagonal = model_->pose_diagonal();
  for (int axis = 0; axis < 3; ++axis)
    solve.unknowns.acceleration[axis] =
        controls.acceleration.allFinite() ? f(controls.acceleration[axis]) : 0.0F;
  place(jaw, controls.activations, *work, solve.boundary);
  float* const x = work->start.data();
  std::copy(work->carried.data(), work->carried.data() + model_->places(), x);
  if (!options.from_last_pose) {  // nothing of the poses before, so that equal controls give equal poses
    std::fill(reach_.begin(), reach_.end(), BoneReach{});
    std::fill(facing_.begin(), facing_.end(), FacingPair{});
  }
  if (options.from_last_pose && pose_offset_.size() > 0)
    model_->loops().add(1.0F, pose_offset_.data(), x, model_->places());
  const Contacts& contacts = model_->face().contacts();
  fill_nodes(x, work->nodes);
  contacts.find_facing(work->nodes.data(), facing_, work->facing_search);
  MinimiseResult result;
  for (int round = 0; round < options.contact_rounds; ++round) {
    const int before = result.iterations;
    result = find_equilibrium(solve, controls, options, x);
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

}  // namespace fascia::sim::realtime
