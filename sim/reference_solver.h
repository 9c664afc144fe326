#pragma once

#include <span>

#include "sim/face_model.h"
#include "sim/minimise.h"
#include "sim/newton.h"
#include "sim/solver.h"

namespace fascia::sim {

/// Options of a static pose.
///
/// Quasi-Newton steps converge quickly in most poses; otherwise Newton steps follow.
struct PoseOptions {
  MinimiseOptions solver{120, 2e-6, 0.005};
  NewtonOptions newton;
  int contact_rounds = 4;           ///< maximum number of contact searches between lips and between lids
  double contact_tolerance = 1e-4;  ///< metres: change of a gap at which they have converged
  bool from_last_pose =
      false;  ///< warm start from the last static pose instead of the rigid motion of the bones
  double jaw_stage =
      0.17;  ///< the jaw opens in stages of at most this fraction of its range, each started from
             ///< the previous one: in a single stage the corners of the mouth may settle folded
};

/// Options of a time step.
struct StepOptions {
  MinimiseOptions solver{16, 3e-7};
  int largest_number_of_substeps = 16;  ///< longer frames are truncated
  double largest_displacement = 0.15;   ///< metres: beyond it the watchdog reports divergence
};

/// Options of the derivative of a static pose.
struct AdjointOptions {
  int iterations = 400;
  double tolerance = 1e-6;  ///< of the residual, relative
};

struct AdjointResult {
  int iterations = 0;
  double residual = 0.0;  ///< of the linear system, relative
  bool converged = false;
};

/// One face: its state, on a shared model. Not thread-safe; different faces are independent.
///
/// Positions are #nodes in the head's frame, metres. Only the constructor, `static_gradient` and the first
/// static pose that needs Newton steps allocate, and nothing throws.
class ReferenceSolver final : public Solver {
 public:
  /// `model` must be valid, have its factors and outlive the face; `channels` is the number of activations.
  /// The options are the defaults of `settle` and `step`.
  ReferenceSolver(const FaceModel& model, size_t channels, const PoseOptions& pose = {},
                  const StepOptions& step = {});

  /// Solves for the static equilibrium under `controls`. Does not change the dynamic state.
  MinimiseResult static_pose(const Controls& controls, const PoseOptions& options,
                             std::span<Vec3f> positions);

  /// The derivative of a loss of the last static pose, which must have been solved for `controls`: one
  /// adjoint solve, whatever the number of channels. `slope` is d loss / d position (#nodes, per metre); the
  /// results are d loss / d activation (#channels) and the same for the jaw's open, forward and lateral.
  /// Exact except for contact between lips, whose normals are held fixed. Allocates at its first call.
  AdjointResult static_gradient(const Controls& controls, std::span<const Vec3> slope,
                                std::span<double> by_channel, std::array<double, 3>& by_jaw,
                                const AdjointOptions& options = {});

  /// Advances time by `seconds` with controls interpolated linearly from the last step's to `controls`, in
  /// the model's fixed substeps, so that the motion hardly depends on the frame rate. Implicit Euler on the
  /// same energies.
  StepResult step(double seconds, const Controls& controls, const StepOptions& options);
  StepResult step(double seconds, const Controls& controls) override {
    return step(seconds, controls, step_options_);
  }

  /// Resets the face to rest on the bones of `controls`, with zero velocity.
  void reset(const Controls& controls = {}) override;
  /// Sets the state to a static pose, with zero velocity.
  MinimiseResult settle(const Controls& controls, const PoseOptions& options);
  MinimiseResult settle(const Controls& controls) override { return settle(controls, pose_options_); }

  /// Node positions after `step`, interpolated between the last two states if the frame ends between them.
  /// #nodes.
  void positions(std::span<Vec3f> out) const;
  /// The same, minus rest: exactly zero at rest.
  void displacements(std::span<Vec3f> out) const override;
  double longest_frame() const override {
    return step_options_.largest_number_of_substeps * model_->options().substep;
  }
  bool exchange_state(StateBytes& bytes) override;
  JawPose shown_jaw(const JawPose&) const override { return time_.shown_jaw(); }
  /// Kinetic plus potential energy of the state, joules.
  double total_energy();
  std::span<const float> activations() const { return time_.activations(); }  ///< after activation dynamics
  const FaceModel& model() const { return *model_; }
  const Positions& velocities() const { return velocity_; }
  Positions& velocities() { return velocity_; }
  const Positions& state() const { return position_; }
  const Positions& pose() const { return pose_; }  ///< the last static pose, in double precision
  const Frame& frame() const { return frame_; }

 private:
  /// The same without stages.
  MinimiseResult pose_at_once(const Controls& controls, const PoseOptions& options,
                              std::span<Vec3f> positions);
  MinimiseResult find_pose(const PoseOptions& options);
  MinimiseResult substep(const Controls& now, const StepOptions& options);
  bool sound(const StepOptions& options) const;

  /// Workspace of `static_gradient`.
  struct Adjoint {
    Positions lambda, direction, product, moved, work, residual, packed, scratch;
    void resize(size_t nodes, size_t unknowns) {
      for (Positions* list : {&lambda, &direction, &product, &moved})
        list->resize(nodes, Vec3::Zero());
      for (Positions* list : {&residual, &packed, &scratch})
        list->resize(unknowns, Vec3::Zero());
      work.resize(3 * nodes, Vec3::Zero());
    }
  };

  const FaceModel* model_;
  PoseOptions pose_options_;
  StepOptions step_options_;
  Adjoint adjoint_;
  Frame frame_, pose_frame_;
  Positions position_, previous_, velocity_, carried_, pose_, pose_offset_, start_, work_;
  Substeps time_;
  MinimiseWorkspace workspace_;
  NewtonWorkspace newton_;  ///< sized at its first use
};

}  // namespace fascia::sim
