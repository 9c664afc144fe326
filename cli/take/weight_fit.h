#pragma once

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "cli/take/components.h"
#include "cli/take/frame_fit.h"

namespace fascia::cli {

/// The weights of given shapes, frame by frame, and what they leave of each frame, measured at every vertex
/// that moves.
///
/// Weights are those of weighted least squares at the vertices that the shapes were judged by. Where a frame
/// is off by more than the tolerance, what is left of it becomes a further shape, and is taken off the frames
/// that follow as well (a greedy reduced basis; Haasdonk 2013), as long as further ones are allowed. Where
/// none are, the frame's weights are chosen for its largest error instead.
class WeightFit {
 public:
  struct Options {
    double tolerance = 0.0;  ///< in the frames' unit
    size_t more_shapes = 0;  ///< at most
  };

  /// `vertices`: those that move, in the order of the shapes' rows.
  WeightFit(std::vector<uint32_t> vertices, Components components, const Options& options);

  /// Takes the next frame: displacements of all vertices of the mesh from rest.
  void add(std::span<const float> displacement);

  /// What comes out of all frames.
  struct Result {
    std::vector<Eigen::VectorXf> shapes;  ///< of 3 #moving vertices each
    Eigen::MatrixXf weights;              ///< #shapes x #frames; the largest of each shape is 1
    std::vector<float> left;  ///< #frames: what is left at most at any vertex, in the frames' unit
  };
  /// Ends the take; nothing may be added afterwards.
  Result finish();

 private:
  void take_block();
  Eigen::MatrixXf weights_of(const Eigen::MatrixXf& frames) const;
  void take_off(Eigen::Index first, const Eigen::MatrixXf& weights, Eigen::MatrixXf& frames) const;
  void add_shapes(Eigen::MatrixXf& left);

  std::vector<uint32_t> vertices_;
  Components components_;
  Options options_;
  std::vector<Eigen::VectorXf> shapes_;  ///< the given ones, then further ones, orthonormal
  Eigen::Index given_ = 0;
  Eigen::MatrixXf judged_shapes_;  ///< given ones at the judged vertices, times the roots of their weights
  Eigen::VectorXf roots_;          ///< 3 #judged vertices
  Eigen::LLT<Eigen::MatrixXd> gram_;
  std::unique_ptr<FrameFit> frame_fit_;
  Eigen::MatrixXf block_;  ///< 3 #moving vertices x #frames of a block
  Eigen::Index waiting_ = 0;
  std::vector<Eigen::MatrixXf> taken_;  ///< weights of each block; later shapes are zero there
  std::vector<float> left_;
};

}  // namespace fascia::cli
