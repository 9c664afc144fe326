#pragma once

#include <span>
#include <vector>

#include "fit/live/landmark.h"
#include "sim/sensitivity.h"

namespace fascia::fit {

/// Jacobian of the landmarks with respect to channels: 3 #landmarks rows, one column per channel, metres.
/// Computed at rest, then recomputed incrementally as the face moves, to distribute the cost over frames.
class LandmarkJacobian {
 public:
  /// `channels` are those of tissue, then the jaw's open, forward and lateral. The model outlives this.
  /// Throws fascia::Error if the rig's stiffness cannot be factored.
  LandmarkJacobian(const sim::FaceModel& model, std::span<const Landmark> landmarks,
                   std::span<const uint32_t> channels);

  const Eigen::MatrixXd& at_rest() const { return at_rest_; }
  /// Discards the computation in progress and restarts from rest.
  void forget();
  /// One part of the next: its matrix, some of its factor or some of its columns; `controls` have made the
  /// pose `nodes`. A new one is begun where the face has gone some way from where the last was. True when
  /// `jacobian` has been made anew, as of where the face stood when it was begun.
  bool renew(const sim::Controls& controls, std::span<const sim::Vec3f> nodes, Eigen::MatrixXd& jacobian);
  /// The same at once: all parts of the next, if one is due. True when `jacobian` has been made anew.
  bool renew_whole(const sim::Controls& controls, std::span<const sim::Vec3f> nodes,
                   Eigen::MatrixXd& jacobian);

 private:
  enum class Stage { idle, factoring, solving };
  void gather(const Eigen::MatrixXd& columns, Eigen::Index first);
  void add_jaw_shares();
  void solve_jaw();

  const sim::FaceModel* model_;
  std::vector<Landmark> landmarks_;
  std::vector<uint32_t> channels_;
  sim::Sensitivity sensitivity_;
  Stage stage_ = Stage::idle;
  size_t next_ = 0;             ///< of the channels, whose column is to be found
  std::vector<float> made_at_;  ///< by channel of the rig
  sim::JawPose jaw_;
  sim::Positions nodes_;
  Eigen::MatrixXd at_rest_, making_;
};

}  // namespace fascia::fit
