#include "runtime/solver.h"

#include <string>

#include "runtime/asset.h"
#include "runtime/bullet_module.h"
#include "runtime/message.h"
#include "sim/realtime/solver.h"

namespace fascia::runtime {
std::unique_ptr<sim::Solver> make_solver(const fascia_face_options& options, const Asset& asset,
                                         std::size_t level) {
  const std::size_t channels = asset.channel_names.size();
  const fascia_solver kind = options.solver;
  require(options.iterations >= 0 && options.iterations <= 32, "iterations must lie between 0 and 32");
  sim::PoseOptions pose;
  if (kind == FASCIA_SOLVER_OWN) {
    pose.solver.iterations = 800;
    pose.newton.iterations = 30;
    sim::realtime::StepOptions step;
    if (options.iterations > 0) step.iterations = options.iterations;
    return std::make_unique<sim::realtime::Solver>(asset.realtime_model(level), channels, pose, step);
  }
  const sim::FaceModel& model = asset.model(level);
  if (kind == FASCIA_SOLVER_REFERENCE) {
    if (!model.has_factors())
      throw Failure(
          FASCIA_ERROR_FORMAT,
          "FASCIA_tissue/levels/" + std::to_string(level) +
              ": its stiffness matrix is singular (some tissue is unconstrained); build the rig again");
    pose.solver.iterations = 200;
    return std::make_unique<sim::ReferenceSolver>(model, channels, pose);
  }
  require(kind == FASCIA_SOLVER_BULLET, "unknown solver");
  if (hosts_allocator.allocate != nullptr)
    throw Failure(FASCIA_ERROR_MODULE, "the module libfascia_bullet cannot use a host's allocator");
  std::unique_ptr<sim::Solver> solver(bullet_entry()(&model, channels));
  if (!solver)
    throw Failure(FASCIA_ERROR_MODULE, "the module libfascia_bullet could not make a solver of this rig");
  return solver;
}

}  // namespace fascia::runtime
