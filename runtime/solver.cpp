#include "runtime/solver.h"

#include <dlfcn.h>

#include <string>

#include "runtime/asset.h"
#include "runtime/message.h"
#include "sim/realtime/face.h"

namespace fascia::runtime {
namespace {

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

std::unique_ptr<sim::Solver> make_solver(const fascia_face_options& options, const Asset& asset,
                                         std::size_t level) {
  const std::size_t channels = asset.channel_names.size();
  const fascia_solver kind = options.solver;
  require(options.iterations >= 0 && options.iterations <= 32, "iterations must lie between 0 and 32");
  sim::PoseOptions pose;
  if (kind == FASCIA_SOLVER_OWN) {
    pose.solver.iterations = 2000;
    sim::realtime::StepOptions step;
    if (options.iterations > 0) step.iterations = options.iterations;
    return std::make_unique<sim::realtime::Face>(asset.realtime_model(level), channels, pose, step);
  }
  const sim::FaceModel& model = asset.model(level);
  if (kind == FASCIA_SOLVER_REFERENCE) {
    if (!model.has_factors())
      throw Failure(FASCIA_ERROR_FORMAT, "FASCIA_tissue/levels/" + std::to_string(level) +
                                             ": its stiffness has no factor; build the rig again");
    pose.solver.iterations = 200;
    return std::make_unique<sim::Face>(model, channels, pose);
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
