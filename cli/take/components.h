#pragma once

#include <Eigen/Core>
#include <vector>

#include "cli/take/motion_space.h"

namespace fascia::cli {

/// A take's motion as few shapes.
struct Components {
  std::vector<Eigen::VectorXf> shapes;  ///< of 3 #moving vertices each
  std::vector<Eigen::Index> judged;     ///< the vertices judged by: their places among those that move
  Eigen::VectorXf vertex_weights;       ///< #judged: in the squared error that the shapes are chosen for
  double sampled_error = 0.0;           ///< at the vertices judged by, in the space's unit
  size_t wanted = 0;  ///< how many components would reach the tolerance; 0: more than the space follows
};

/// As few components as bring the vertices judged by within `tolerance` in every frame, at most `limit`.
///
/// Vertices judged by are those that would be off most, and an even sample of the others. The components are
/// principal ones. Where `limit` of them do not reach the tolerance, vertices and frames that are off most
/// are given more weight until the largest error falls no more (Lawson's iteration; Lawson 1961, Rice & Usow
/// 1968), since it is the largest error that counts.
Components components(const MotionSpace& space, size_t limit, double tolerance);

}  // namespace fascia::cli
