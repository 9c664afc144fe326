#pragma once

#include <span>
#include <vector>

#include "sim/realtime/model.h"
#include "sim/reference_solver.h"

namespace fascia::sim::realtime {

/// Options of a time step in real time.
struct StepOptions {
  /// Of each substep. A substep with a large residual after two or more is continued with line search, once
  /// per frame; from eight on all iterations use line search.
  int iterations = 2;
  double tolerance = 3e-7;   ///< metres: a substep ends early if no node would move farther
  bool checks_last = false;  ///< whether all iterations use line search; costs about one more iteration
  int largest_number_of_substeps = 16;  ///< longer frames are truncated
  double largest_displacement = 0.15;   ///< metres: beyond it the watchdog reports divergence
};

/// One face in real time: the counterpart of sim::ReferenceSolver, with the same energies, many times faster.
///
/// Positions are in single precision and scratch memory is borrowed from the model, so a face is small. Not
/// thread-safe; different faces are independent. Only the constructor, the first use of scratch memory and
/// static poses that need Newton steps allocate; nothing throws.
class Solver final : public sim::Solver {
 public:
  /// `model` must be valid and outlive the face; `channels` is the number of activations. The options are the
  /// defaults of `settle` and `step`.
  Solver(const Model& model, size_t channels, const PoseOptions& pose = {}, const StepOptions& step = {});

  /// See sim::ReferenceSolver.
  MinimiseResult static_pose(const Controls& controls, const PoseOptions& options,
                             std::span<Vec3f> positions);
  StepResult step(double seconds, const Controls& controls, const StepOptions& options);
  StepResult step(double seconds, const Controls& controls) override {
    return step(seconds, controls, step_options_);
  }
  void reset(const Controls& controls = {}) override;
  MinimiseResult settle(const Controls& controls, const PoseOptions& options);
  MinimiseResult settle(const Controls& controls) override { return settle(controls, pose_options_); }
  /// The next static pose `from_last_pose` starts from the last one of `other`, the solver of a model that
  /// differs in constants alone: the nodes are the same.
  void continue_from(const Solver& other);
  void positions(std::span<Vec3f> out) const;
  void displacements(std::span<Vec3f> out) const override;
  double longest_frame() const override {
    return step_options_.largest_number_of_substeps * model_->face().options().substep;
  }
  bool exchange_state(StateBytes& bytes) override;
  JawPose shown_jaw(const JawPose&) const override { return time_.shown_jaw(); }

  /// Bytes of memory owned by this face.
  size_t memory() const;
  std::span<const float> activations() const { return time_.activations(); }

 private:
  /// The same without stages.
  MinimiseResult pose_at_once(const Controls& controls, const PoseOptions& options,
                              std::span<Vec3f> positions);
  struct HessianPreconditioner;
  struct Solve;
  struct Space;

  void place(const JawPose& jaw, std::span<const float> activations, Workspace& work,
             Boundary& boundary) const;
  void fill_nodes(const float* x, Positions& nodes) const;
  double contact_energy(Solve& solve, const float* x, float* gradient);
  double evaluate(Solve& solve, const float* x, bool wants_energy = true);
  MinimiseResult minimise(Solve& solve, const MinimiseOptions& options, float* x);
  MinimiseResult find_equilibrium(Solve& solve, const Controls& controls, const PoseOptions& options,
                                  float* x);
  /// Few iterations without line search, for a substep.
  MinimiseResult iterate(Solve& solve, const MinimiseOptions& options, float* x);
  MinimiseResult substep(const Controls& now, const StepOptions& options, int& searches_left,
                         Workspace& work);
  /// Moves the nodes of prisms inverted by a substep of few iterations back toward its beginning; false if
  /// some remain inverted.
  bool untangle(Workspace& work, float* x) const;
  /// False if a prism was inverted; its nodes are then moved back if that helps, and marked.
  bool is_upright(Workspace& work, size_t layer, size_t triangle, float* x) const;
  bool sound(const float* carried, double largest) const;

  const Model* model_;
  PoseOptions pose_options_;
  StepOptions step_options_;
  Floats position_, velocity_, carried_, before_, last_direction_, step_scale_, pose_offset_;
  std::vector<FacingPair> facing_;
  struct BoneReach {
    float place[3] = {0, 0, 0};  ///< in the bone's frame, at the last evaluation of the distance
    float free = -1.0F;          ///< radius around it without contact, metres; negative: unknown
  };
  std::vector<BoneReach> reach_;  ///< of each contact with bone
  Substeps time_;
  RigidTransform last_mandible_;
  uint32_t turn_ = 0;  ///< substeps since the last reset
};

}  // namespace fascia::sim::realtime
