#pragma once

#include <span>
#include <vector>

#include "sim/face.h"
#include "sim/realtime/model.h"

namespace fascia::sim::realtime {

/// How time passes for a face in real time.
struct StepOptions {
  ActivationDynamics dynamics;
  /// Of each substep; one far from settled after two or more takes some further ones that are searched along,
  /// once a frame, and from eight on all are.
  int iterations = 2;
  double tolerance = 3e-7;  ///< metres: largest move of a node still wanted when a substep ends earlier
  bool checks_last =
      false;  ///< whether iterations are searched along however few they are; costs as much as one more
  int largest_number_of_substeps = 16;  ///< a longer frame loses the rest of its time
  double largest_displacement = 0.15;   ///< metres: beyond it the watchdog calls the face diverged
};

/// One face on a model laid out for the loops: what sim::Face does, on the same energies, many times faster.
///
/// Positions are single precision and work memory is borrowed from the model, so a face is small. Not for two
/// threads at once; different faces are free. Nothing but the constructor and the first use of borrowed
/// memory allocates; nothing throws.
class Face final : public Solver {
 public:
  /// `model` must be valid and outlive the face; `channels` is how many activations it listens to. The
  /// options are those of `settle` and `step` without options.
  Face(const Model& model, size_t channels, const PoseOptions& pose = {}, const StepOptions& step = {});

  /// See sim::Face.
  MinimiseResult static_pose(const Controls& controls, const PoseOptions& options,
                             std::span<Vec3f> positions);
  StepResult step(double seconds, const Controls& controls, const StepOptions& options);
  StepResult step(double seconds, const Controls& controls) override {
    return step(seconds, controls, step_options_);
  }
  void reset(const Controls& controls = {}) override;
  MinimiseResult settle(const Controls& controls, const PoseOptions& options);
  MinimiseResult settle(const Controls& controls) override { return settle(controls, pose_options_); }
  void positions(std::span<Vec3f> out) const;
  void displacements(std::span<Vec3f> out) const override;
  double longest_frame() const override {
    return step_options_.largest_number_of_substeps * model_->face().options().substep;
  }
  bool exchange_state(StateBytes& bytes) override;
  JawPose shown_jaw(const JawPose&) const override { return time_.shown_jaw(); }

  /// Bytes this face keeps for itself.
  size_t memory() const;
  std::span<const float> activations() const { return time_.activations(); }

 private:
  /// The same without stages.
  MinimiseResult pose_at_once(const Controls& controls, const PoseOptions& options,
                              std::span<Vec3f> positions);
  struct Solve;
  struct Space;

  void place(const JawPose& jaw, std::span<const float> activations, Workspace& work,
             Boundary& boundary) const;
  void fill_nodes(const float* x, Positions& nodes) const;
  double contact_energy(Solve& solve, const float* x, float* gradient);
  double evaluate(Solve& solve, const float* x, bool wants_energy = true);
  MinimiseResult minimise(Solve& solve, const MinimiseOptions& options, float* x);
  /// Few iterations without line search, for a substep.
  MinimiseResult iterate(Solve& solve, const MinimiseOptions& options, float* x);
  MinimiseResult substep(const Controls& now, const StepOptions& options, int& searches_left,
                         Workspace& work);
  /// Takes the nodes of prisms that a substep of few iterations has turned inside out back towards where it
  /// began; false when some are left.
  bool untangle(Workspace& work, float* x) const;
  /// False when a prism was not upright; its nodes are then taken back if that helps, and marked.
  bool is_upright(Workspace& work, size_t layer, size_t triangle, float* x) const;
  bool sound(const float* carried, double largest) const;

  const Model* model_;
  PoseOptions pose_options_;
  StepOptions step_options_;
  Floats position_, velocity_, carried_, before_, last_direction_, step_scale_, pose_offset_;
  std::vector<FacingPair> facing_;
  struct BoneReach {
    float place[3] = {0, 0, 0};  ///< in the bone's frame, where the distance was last looked up
    float free = -1.0F;          ///< metres from there within which it cannot touch; negative: not known
  };
  std::vector<BoneReach> reach_;  ///< of each contact with bone
  Substeps time_;
  RigidTransform last_mandible_;
  uint32_t turn_ = 0;  ///< substeps since the last reset
};

}  // namespace fascia::sim::realtime
