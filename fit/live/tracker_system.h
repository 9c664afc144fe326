#pragma once

#include <Eigen/Core>

#include "fit/live/tracker.h"
#include "geometry/mesh.h"

namespace fascia::fit {

/// Unknowns are the head's turn, shift and growth, then the channels.
struct Tracker::System {
  static constexpr int head = 7;
  using HeadMatrix = Eigen::Matrix<double, head, head>;
  using HeadVector = Eigen::Matrix<double, head, 1>;

  Eigen::MatrixXd rows, weighted;  ///< 3 #landmarks x #fitted: what the camera sees of the Jacobian
  Eigen::MatrixXd head_rows, head_weighted;
  Eigen::VectorXd missing;  ///< 3 #landmarks
  Eigen::MatrixXd curvature;
  Eigen::MatrixXd across, solved;
  Eigen::VectorXd slope, move, pull;

  System(Eigen::Index landmarks, Eigen::Index channels)
      : rows(3 * landmarks, channels),
        weighted(3 * landmarks, channels),
        head_rows(3 * landmarks, head),
        head_weighted(3 * landmarks, head),
        missing(3 * landmarks),
        curvature(channels, channels),
        across(head, channels),
        solved(head, channels),
        slope(channels),
        move(channels),
        pull(channels) {}

  static Mat3 cross_matrix(const Vec3& v) {
    Mat3 matrix;
    matrix << 0.0, -v.z(), v.y(), v.z(), 0.0, -v.x(), -v.y(), v.x(), 0.0;
    return matrix;
  }
  /// A turn, a shift and a growth of the head move a place of it.
  static Eigen::Matrix<double, 3, head> head_motion(const Vec3& place, bool moves_scale) {
    Eigen::Matrix<double, 3, head> motion;
    motion << -cross_matrix(place), Mat3::Identity(), moves_scale ? place : Vec3(Vec3::Zero());
    return motion;
  }
  /// So that what nothing tells of the head stays as it is.
  static HeadMatrix with_floor(HeadMatrix matrix) {
    const double turn = matrix.topLeftCorner<3, 3>().trace(), shift = matrix.block<3, 3>(3, 3).trace();
    matrix.diagonal().head<3>().array() += 1e-6 * turn + 1e-30;
    matrix.diagonal().segment<3>(3).array() += 1e-6 * shift + 1e-30;
    matrix(6, 6) += 1e-6 * turn + 1e-30;
    return matrix;
  }
};

}  // namespace fascia::fit
