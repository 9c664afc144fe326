#pragma once

#include <Eigen/Core>

#include "cli/take/motion_space.h"

namespace fascia::cli {

/// A take's motion as few shapes and their weights over time.
struct Components {
  Eigen::MatrixXf shapes;      ///< 3 #moving vertices x #components
  Eigen::MatrixXf mix;         ///< #directions x #components: what each shape is made of
  Eigen::MatrixXf weights;     ///< #components x #frames; the largest of each component is 1
  double sampled_error = 0.0;  ///< at the vertices judged by, in the space's unit
  size_t wanted = 0;  ///< how many components would reach the tolerance; 0: more than the space follows
};

/// As few components as bring the vertices judged by within `tolerance` in every frame, at most `limit`.
///
/// Vertices judged by are those that would be off most, and an even sample of the others. The components are
/// principal ones. Where `limit` of them do not reach the tolerance, vertices and frames that are off most
/// are given more weight until the largest error falls no more (Lawson's iteration; Lawson 1961, Rice & Usow
/// 1968), since it is the largest error that counts; then the weights of the frames that are off most are
/// chosen for their own largest error.
Components components(const MotionSpace& space, size_t limit, double tolerance);

}  // namespace fascia::cli
