#include "runtime/solver.h"

#include <dlfcn.h>

#include <string>

#include "runtime/asset.h"
#include "runtime/message.h"
#include "sim/realtime/face.h"
#include "sim/solver.h"

namespace fascia::runtime {
namespace {

/// Fascia's own solver: in real time, or the reference, whose faces speak alike.
template <class Face, class StepOptions>
class FaceSolver : public Solver {
 public:
  template <class Model, class Options>
  FaceSolver(const Model& model, std::size_t channels, int pose_iterations, const Options& step)
      : face_(model, channels), step_(step) {
    pose_.solver.iterations = pose_iterations;
  }

  void pose(const sim::Drive& drive, std::span<sim::Vec3f> displacements) override {
    face_.settle(drive, pose_);
    face_.displacements(displacements);
  }
  bool step(double seconds, const sim::Drive& drive, std::span<sim::Vec3f> displacements) override {
    const sim::StepResult result = face_.step(seconds, drive, step_);
    face_.displacements(displacements);
    return result.status == sim::StepStatus::done;
  }
  void reset(const sim::Drive& drive, std::span<sim::Vec3f> displacements) override {
    face_.reset(drive);
    face_.displacements(displacements);
  }

 private:
  Face face_;
  StepOptions step_;
  sim::PoseOptions pose_;
};

/// A solver from a module, behind sim's interface, which speaks of positions.
class ModuleSolver : public Solver {
 public:
  ModuleSolver(std::unique_ptr<sim::Solver> solver, const sim::FaceModel& model)
      : solver_(std::move(solver)), model_(model) {}

  void pose(const sim::Drive& drive, std::span<sim::Vec3f> displacements) override {
    solver_->static_pose(drive, displacements);
    subtract_rest(displacements);
  }
  bool step(double seconds, const sim::Drive& drive, std::span<sim::Vec3f> displacements) override {
    const sim::StepResult result = solver_->step(seconds, drive);
    solver_->positions(displacements);
    subtract_rest(displacements);
    return result.status == sim::StepStatus::done;
  }
  void reset(const sim::Drive& drive, std::span<sim::Vec3f> displacements) override {
    solver_->reset(drive);
    solver_->positions(displacements);
    subtract_rest(displacements);
  }

 private:
  void subtract_rest(std::span<sim::Vec3f> positions) const {
    for (std::size_t i = 0; i < positions.size(); ++i)
      positions[i] -= model_.lattice().rest[i];
  }

  std::unique_ptr<sim::Solver> solver_;
  const sim::FaceModel& model_;
};

/// Folder this library lies in, with a slash at its end; empty when it is not known.
std::string own_folder() {
  Dl_info info{};
  if (dladdr(reinterpret_cast<const void*>(&fascia_version), &info) == 0 || info.dli_fname == nullptr)
    return "";
  const std::string path = info.dli_fname;
  const std::size_t slash = path.rfind('/');
  return slash == std::string::npos ? "" : path.substr(0, slash + 1);
}

/// The entry of libfascia_bullet, loaded once and kept.
sim::MakeSolver bullet_entry() {
  static void* const module = [] {
    const std::string name = "libfascia_bullet.so";
    void* found = dlopen((own_folder() + name).c_str(), RTLD_NOW | RTLD_LOCAL);
    return found != nullptr ? found : dlopen(name.c_str(), RTLD_NOW | RTLD_LOCAL);
  }();
  if (module == nullptr)
    throw Failure(
        FASCIA_ERROR_MODULE,
        "the module libfascia_bullet is not there; install it beside this library, or use FASCIA_SOLVER_OWN");
  void* const entry = dlsym(module, sim::solver_entry);
  if (entry == nullptr)
    throw Failure(FASCIA_ERROR_MODULE, "libfascia_bullet is of another version than this library");
  return reinterpret_cast<sim::MakeSolver>(entry);
}

}  // namespace

std::unique_ptr<Solver> make_solver(const fascia_face_options& options, const Asset& asset,
                                    std::size_t level) {
  const std::size_t channels = asset.channel_names.size();
  const fascia_solver kind = options.solver;
  require(options.iterations >= 0 && options.iterations <= 32, "iterations must lie between 0 and 32");
  if (kind == FASCIA_SOLVER_OWN) {
    sim::realtime::StepOptions step;
    if (options.iterations > 0) step.iterations = options.iterations;
    return std::make_unique<FaceSolver<sim::realtime::Face, sim::realtime::StepOptions>>(
        asset.realtime_model(level), channels, 2000, step);
  }
  const sim::FaceModel& model = asset.model(level);
  if (kind == FASCIA_SOLVER_REFERENCE)
    return std::make_unique<FaceSolver<sim::Face, sim::StepOptions>>(model, channels, 200,
                                                                     sim::StepOptions{});
  require(kind == FASCIA_SOLVER_BULLET, "unknown solver");
  std::unique_ptr<sim::Solver> solver(bullet_entry()(&model, channels));
  if (!solver)
    throw Failure(FASCIA_ERROR_MODULE, "the module libfascia_bullet could not make a solver of this rig");
  return std::make_unique<ModuleSolver>(std::move(solver), model);
}

}  // namespace fascia::runtime
