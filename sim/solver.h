#pragma once

#include <span>

#include "sim/state_bytes.h"
#include "sim/substeps.h"

namespace fascia::sim {

/// The interface of the solvers of a face: the real-time solver, the double-precision reference, and Bullet's
/// (in a library loaded on demand). For one thread at a time.
class Solver {
 public:
  virtual ~Solver() = default;

  /// Advances time by `seconds`, with controls interpolated from the last step's to `controls`.
  virtual StepResult step(double seconds, const Controls& controls) = 0;
  /// Sets the state to the static equilibrium under `controls`, with zero velocity.
  virtual MinimiseResult settle(const Controls& controls) = 0;
  /// Resets the face to rest on the bones of `controls`, without muscle activation and velocity.
  virtual void reset(const Controls& controls) = 0;
  /// Displacements of the nodes, metres, #nodes; exactly zero at rest.
  virtual void displacements(std::span<Vec3f> out) const = 0;
  /// Longest frame in seconds; longer ones are truncated.
  virtual double longest_frame() const = 0;
  /// Saves or restores the complete state (see StateBytes): the motion then continues bit-identically. False
  /// if the solver does not support it, or if the bytes read are not a state of its model.
  virtual bool exchange_state(StateBytes& /*bytes*/) { return false; }
  /// The jaw under `displacements`, where the last controls had `jaw`.
  virtual JawPose shown_jaw(const JawPose& jaw) const { return jaw; }
};

/// The function that a solver library exports under the name in `solver_entry`: creates a solver on `model`,
/// which must outlive it, for a number of channels; null if the model is not valid. The caller deletes it.
using MakeSolver = Solver* (*)(const FaceModel* model, size_t channels);
inline constexpr const char* solver_entry = "fascia_make_solver";

}  // namespace fascia::sim
