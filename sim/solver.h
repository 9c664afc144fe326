#pragma once

#include "sim/face.h"

namespace fascia::sim {

/// A solver of a face behind one interface, so that a host may choose. `Face` needs none of this; other
/// solvers, some in libraries loaded on demand, are reached through it.
class Solver {
 public:
  virtual ~Solver() = default;

  /// Lets `seconds` pass under `drive`.
  virtual StepResult step(double seconds, const Drive& drive) = 0;
  /// The pose the solver comes to rest in under `drive`, without keeping the motion. #nodes, metres.
  virtual void static_pose(const Drive& drive, std::span<Vec3f> positions) = 0;
  virtual void reset(const Drive& drive) = 0;
  virtual void positions(std::span<Vec3f> out) const = 0;
};

/// What a solver library exports under the name in `solver_entry`: makes a solver on `model`, which outlives
/// it, for so many channels; null when the model is not valid. The caller deletes it.
using MakeSolver = Solver* (*)(const FaceModel* model, size_t channels);
inline constexpr const char* solver_entry = "fascia_make_solver";

}  // namespace fascia::sim
