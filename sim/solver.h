#pragma once

#include <span>

#include "sim/state_bytes.h"
#include "sim/substeps.h"

namespace fascia::sim {

/// A solver of one face: its state, and what moves it. Fascia's own in real time, the reference in double
/// precision, and Bullet's (in a library loaded on demand) are all reached through it. For one thread at a
/// time.
class Solver {
 public:
  virtual ~Solver() = default;

  /// Lets `seconds` pass while the controls go from the last step's to `controls`.
  virtual StepResult step(double seconds, const Controls& controls) = 0;
  /// Takes the pose in which the face comes to rest under `controls` as the state, without velocity.
  virtual MinimiseResult settle(const Controls& controls) = 0;
  /// Puts the face at rest under `controls`'s bones, muscles slack, without velocity.
  virtual void reset(const Controls& controls) = 0;
  /// How far the nodes are from rest, metres, #nodes; at rest exactly zero.
  virtual void displacements(std::span<Vec3f> out) const = 0;
  /// Seconds of which a longer frame loses the rest.
  virtual double longest_frame() const = 0;
  /// Takes all that the next steps depend on out to bytes or back (see StateBytes): afterwards the motion
  /// goes on to the last bit. False when this solver cannot, or when what was read cannot be a state of its
  /// model.
  virtual bool exchange_state(StateBytes& /*bytes*/) { return false; }
  /// The jaw under `displacements`, where the last controls had `jaw`.
  virtual JawPose shown_jaw(const JawPose& jaw) const { return jaw; }
};

/// What a solver library exports under the name in `solver_entry`: makes a solver on `model`, which outlives
/// it, for so many channels; null when the model is not valid. The caller deletes it.
using MakeSolver = Solver* (*)(const FaceModel* model, size_t channels);
inline constexpr const char* solver_entry = "fascia_make_solver";

}  // namespace fascia::sim
