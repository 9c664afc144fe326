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
  /// What activations cost, in square millimetres of mean squared distance: their squares and their sizes,
  /// the square of a change from one frame to the next. Channels that the rig's expression tables seldom use
  /// cost more.
  double ridge = 1e-3;
  double sparsity = 2e-4;
  double smoothness = 5e-2;
  int iterations = 2;       ///< Gauss-Newton steps a frame, each with one pose of the simulation
  bool finds_scale = true;  ///< of the observed face against the rig's, in the first frame; not of pictures
  std::optional<Camera> camera;  ///< points are pixels of it, not places
};

/// What one frame has told. Lengths in metres of the head, but where said.
struct Tracked {
  std::vector<float> activations;  ///< one a channel of the rig
  HeadPose head;                   ///< from the rig's metres to the space of the points
  std::vector<Vec3> landmarks;     ///< #landmarks: where the fitted face has them, in the space of the points
  std::vector<Vec3> at_rest;       ///< the same of the face at rest in the same pose
  double rms_mm = 0.0;             ///< root weighted mean square distance left, on the head
  uint32_t seen = 0;               ///< landmarks that counted
};

/// Activations and head pose from a stream of landmarks, a frame at a time.
///
/// Every frame takes few Gauss-Newton steps in the channels' ranges on the full nonlinear simulation, as the
/// fit of whole meshes does; but the Jacobian of the landmarks is kept, corrected by what each step did
/// (Broyden 1965, "A class of methods for solving nonlinear simultaneous equations"), and made anew over some
/// ten frames, each bearing a part of it. The head's pose is solved along and eliminated. A channel none of
/// whose landmarks is seen holds its value; the costs of the others fade with what is seen of them.
///
/// Same input, same output. Not for two threads at once.
class Tracker {
 public:
  /// The models are of one level of the rig and outlive this. Throws fascia::Error when there are no
  /// landmarks that move with anything, or the rig has no jaw channels or no stiffness.
  Tracker(const sim::FaceModel& model, const sim::realtime::Model& fast_model,
          const rig::Actuation& actuation, std::vector<Landmark> landmarks, const TrackerOptions& options);
  ~Tracker();

  size_t size() const { return landmarks_.size(); }
  const TrackerOptions& options() const { return options_; }

  /// Forgets all frames, not the neutral.
  void reset();

  /// Takes where the same detector has the landmarks of the same face at rest: what its places differ by from
  /// ours no longer counts. Arguments as of `follow`. False, and nothing is changed, when too few are seen to
  /// tell where the head is.
  bool take_neutral(std::span<const Vec3> points, std::span<const double> weights);

  /// The next frame: #landmarks points (the camera's x and y where there is one) and their weights, 0 for one
  /// that is not seen, 1 for one seen well. A frame that shows too little holds the last one's result.
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
  void weigh_channels(std::span<const double> weights, bool is_first);
  double step(std::span<const Vec3> points, std::span<const double> weights, bool moves_scale);
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
  std::unique_ptr<System> system_;
  std::unique_ptr<LandmarkJacobian> renewed_;
  HeadPose head_;
  double neutral_scale_ = 0.0;  ///< 0: not known
  bool is_tracking_ = false;
  Tracked result_;
};

}  // namespace fascia::fit
