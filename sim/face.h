#pragma once

#include <span>

#include "sim/face_model.h"
#include "sim/minimise.h"
#include "sim/newton.h"
#include "sim/solver.h"

namespace fascia::sim {

/// How a static pose is solved.
///
/// Quasi-Newton steps first, which end soon in most poses; what they have not brought to an end, Newton steps
/// do.
struct PoseOptions {
  MinimiseOptions solver{120, 2e-6, 0.005};
  NewtonOptions newton;
  int contact_rounds = 4;           ///< how often at most lips and lids look again for what they face
  double contact_tolerance = 1e-4;  ///< metres a gap may still change when they do
  bool from_last_pose = false;      ///< start from the last static pose instead of the bones' motion alone
  double jaw_stage = 0.17;  ///< the jaw opens in stages of at most this share of its way, each begun from
                            ///< the one before: carried at once, the mouth's corners may settle folded
};

/// How time passes for a face.
struct StepOptions {
  ActivationDynamics dynamics;
  MinimiseOptions solver{16, 3e-7};
  int largest_number_of_substeps = 16;  ///< a longer frame loses the rest of its time
  double largest_displacement = 0.15;   ///< metres: beyond it the watchdog calls the face diverged
};

/// How the derivative of a static pose is solved.
struct AdjointOptions {
  int iterations = 400;
  double tolerance = 1e-6;  ///< of the residual, relative
};

struct AdjointResult {
  int iterations = 0;
  double residual = 0.0;  ///< left of the linear system, relative
  bool converged = false;
};

/// One face: its own state on a shared model. Not for two threads at once; different faces are free.
///
/// Positions are #nodes in the head's frame, metres. Nothing here but the constructor, `static_gradient` and
/// the first hard static pose allocates, and nothing throws.
class Face final : public Solver {
 public:
  /// `model` must be valid, have its factors and outlive the face; `channels` is how many activations it
  /// listens to. The options are those of `settle` and `step` without options.
  Face(const FaceModel& model, size_t channels, const PoseOptions& pose = {}, const StepOptions& step = {});

  /// The pose in which all forces of `controls` balance. Does not touch the state that `step` moves.
  MinimiseResult static_pose(const Controls& controls, const PoseOptions& options,
                             std::span<Vec3f> positions);

  /// The derivative of a loss of the last static pose, which `controls` must have made: one linear solve,
  /// whatever the number of channels. `slope` is d loss / d position (#nodes, per metre); out come d loss / d
  /// activation (#channels) and the same for the jaw's open, forward and lateral. Exact but for contact
  /// between lips, whose normals are held still. Allocates at its first call.
  AdjointResult static_gradient(const Controls& controls, std::span<const Vec3> slope,
                                std::span<double> by_channel, std::array<double, 3>& by_jaw,
                                const AdjointOptions& options = {});

  /// Lets `seconds` pass while the controls go from the last step's to `controls` along a line; time is cut
  /// into the model's substeps, so the frame rate hardly changes the motion. Implicit Euler on the same
  /// energies.
  StepResult step(double seconds, const Controls& controls, const StepOptions& options);
  StepResult step(double seconds, const Controls& controls) override {
    return step(seconds, controls, step_options_);
  }

  /// Puts the face at rest under `controls`'s bones, without velocity.
  void reset(const Controls& controls = {}) override;
  /// Takes a static pose as the state, without velocity.
  MinimiseResult settle(const Controls& controls, const PoseOptions& options);
  MinimiseResult settle(const Controls& controls) override { return settle(controls, pose_options_); }

  /// Where `step` has brought the nodes, between the last two states where a frame ends there. #nodes.
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
  std::span<const float> activations() const { return time_.activations(); }  ///< after their dynamics
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

  /// What `static_gradient` needs of memory.
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
