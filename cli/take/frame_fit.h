#pragma once

#include <Eigen/Core>

namespace fascia::cli {

/// Weights of single frames on given shapes for a small largest error instead of a small squared one:
/// iteratively reweighted least squares towards the 10-norm (Burrus, Barreto & Selesnick 1994).
class FrameFit {
 public:
  /// `shapes`: 3 #vertices x #shapes.
  explicit FrameFit(Eigen::MatrixXf shapes);

  /// Moves `weights` (#shapes) toward the optimum for a frame of which they leave `off` (3 #vertices). Only
  /// frames with large errors change: up to `small` the weights are kept, from `large` on they become the
  /// optimum, and in between they are blended, so that the motion remains as smooth as it was.
  void improve(Eigen::VectorXf off, float small, float large, Eigen::Ref<Eigen::VectorXf> weights) const;

 private:
  Eigen::MatrixXf shapes_, gram_;
};

}  // namespace fascia::cli
