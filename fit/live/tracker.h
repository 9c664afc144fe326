#pragma once

#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "fit/live/bounded_step.h"
#include "fit/live/head_pose.h"
#include "fit/live/landmark.h"
#include "fit/live/landmark_jacobian.h"
#include "rig/model/rig.h"
#include "sim/realtime/solver.h"

namespace fascia::fit {

struct TrackerOptions {
  /// Penalties in square millimetres of mean squared distance, on squared and absolute activations and on
  /// squared changes from frame to frame. They are larger for channels that the rig's expression tables
  /// rarely use.
  double ridge = 1e-3;
  double sparsity = 2e-4;
  double smoothness = 5e-2;
  int iterations = 2;  ///< Gauss-Newton steps per frame at most, each with one static pose
  /// For recordings: a frame's steps end when they gain nothing more, and the Jacobian is recomputed as a
  /// whole when the face has moved, whatever that takes.
  bool may_take_time = false;
  bool finds_scale = true;  ///< of the observed face against the rig's, in the first frame; not of pictures
  std::optional<Camera> camera;  ///< if given, points are its pixels
};

/// The result of a frame. Lengths in metres of the head unless stated otherwise.
struct Tracked {
  std::vector<float> activations;  ///< one per channel of the rig
  HeadPose head;                   ///< from the rig's metres to the space of the points
  std::vector<Vec3> landmarks;     ///< #landmarks: where the fitted face has them, in the space of the points
  std::vector<Vec3> at_rest;       ///< the same of the face at rest in the same pose
  double rms_mm = 0.0;             ///< weighted root mean square residual, on the head
  uint32_t seen = 0;               ///< landmarks used
  int steps = 0;                   ///< Gauss-Newton steps of this frame
  bool is_settled = false;         ///< the last of them moved no channel or gained nothing
};

/// Tracks activations and head pose in a stream of landmarks, frame by frame.
///
/// Every frame performs a few Gauss-Newton steps within the channels' ranges on the full nonlinear
/// simulation, as in the fit of whole meshes; but the Jacobian of the landmarks is updated after each step
/// (Broyden 1965, "A class of methods for solving nonlinear simultaneous equations") and recomputed
/// incrementally over about ten frames. The head's pose is solved simultaneously and eliminated. An
/// unobservable channel keeps its value; the penalties of the others decrease with their observability.
///
/// Deterministic. Not thread-safe.
class Tracker {
 public:
  /// The models are of one level of the rig and outlive this. Throws fascia::Error when there are no
  /// landmarks that move with anything, or the rig has no jaw channels or no stiffness.
  Tracker(const sim::FaceModel& model, const sim::realtime::Model& fast_model,
          const rig::Actuation& actuation, std::vector<Landmark> landmarks, const TrackerOptions& options);
  ~Tracker();

  size_t size() const { return landmarks_.size(); }
  const TrackerOptions& options() const { return options_; }

  /// Resets the tracking, but keeps the neutral calibration.
  void reset();

  /// Calibrates with landmarks of the same face at rest from the same detector, so that systematic
  /// differences cancel. Arguments as for `follow`. False, with no change, if too few are visible to
  /// determine the head's pose.
  bool take_neutral(std::span<const Vec3> points, std::span<const double> weights);

  /// The next frame: #landmarks points (the camera's x and y where there is one) and their weights, 0 for an
  /// invisible point, 1 for a fully visible one. With too few points the last result is kept.
  const Tracked& follow(std::span<const Vec3> points, std::span<const double> weights);
  const Tracked& result() const { return result_; }

 private:
  struct System;  ///< the normal equations of a step
  /// Where landmarks are under the present values; afterwards `places_` has them.
  void pose(bool is_first);
  sim::Controls controls() const;
  bool find_head(std::span<const Vec3> points, std::span<const double> weights, bool is_first);
  void refine_head(std::span<const Vec3> points, std::span<const double> weights, int steps);
  Vec3 miss(size_t landmark, const Vec3& point, Mat3& seen) const;
  double mean_square(std::span<const Vec3> points, std::span<const double> weights) const;
  double objective(std::span<const Vec3> points, std::span<const double> weights) const;
  void weigh_channels(std::span<const double> weights, bool is_first);
  double step(std::span<const Vec3> points, std::span<const double> weights, bool moves_scale);
  void iterate(std::span<const Vec3> points, std::span<const double> weights, int most, bool moves_scale);
  void correct_jacobian();
  void report(std::span<const Vec3> points, std::span<const double> weights);

  const sim::FaceModel* model_;
  std::vector<Landmark> landmarks_;
  TrackerOptions options_;
  std::unique_ptr<sim::realtime::Solver> face_;
  std::vector<uint32_t> fitted_;  ///< channels, those of the jaw last
  std::vector<StepBound> ranges_, bounds_;
  std::vector<double> dearness_, ridge_, smoothness_;  ///< by fitted channel
  std::vector<float> rest_, values_, last_;            ///< by channel
  std::vector<Vec3> offsets_, places_, places_before_, targets_;
  std::vector<sim::Vec3f> nodes_;
  Eigen::MatrixXd jacobian_;  ///< 3 #landmarks x #fitted
  Eigen::MatrixXd reach_;     ///< #landmarks x #fitted: squared lengths of it at rest
  Eigen::VectorXd move_;      ///< of the last step
  double farthest_ = 0.0;     ///< that a step may move a channel
  std::unique_ptr<System> system_;
  std::unique_ptr<LandmarkJacobian> renewed_;
  HeadPose head_;
  double neutral_scale_ = 0.0;  ///< 0: not known
  bool is_tracking_ = false;
  Tracked result_;
};

}  // namespace fascia::fit
