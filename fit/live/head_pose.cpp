#include "fit/live/head_pose.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <cmath>

#include "geometry/alignment.h"

namespace fascia::fit {
void HeadPose::move(const Vec3& turn, const Vec3& shift, double growth) {
  translation += scale * (rotation * shift);
  const double angle = turn.norm();
  if (angle > 0.0) rotation = nearest_rotation(rotation * Eigen::AngleAxisd(angle, turn / angle));
  scale *= std::exp(growth);
}

std::optional<HeadPose> pose_between(std::span<const Vec3> from, std::span<const Vec3> to,
                                     std::span<const double> weights, bool may_scale) {
  Vec3 middle = Vec3::Zero();
  double sum = 0.0;
  size_t count = 0;
  for (size_t i = 0; i < from.size(); ++i) {
    count += weights[i] > 0.0 ? 1 : 0;
    sum += weights[i];
    middle += weights[i] * from[i];
  }
  if (count < 3) return {};
  middle /= sum;
  Mat3 spread = Mat3::Zero();
  for (size_t i = 0; i < from.size(); ++i)
    spread += weights[i] * (from[i] - middle) * (from[i] - middle).transpose();
  const Vec3 along = principal_axes(spread).values;
  if (!(along[1] > 1e-9 * along[2])) return {};
  const Mat4 best = may_scale ? similarity(from, to, weights) : rigid_motion(from, to, weights);
  HeadPose pose;
  pose.scale = may_scale ? std::cbrt(best.topLeftCorner<3, 3>().determinant()) : 1.0;
  if (!(pose.scale > 0.0) || !best.allFinite()) return {};
  pose.rotation = best.topLeftCorner<3, 3>() / pose.scale;
  pose.translation = best.topRightCorner<3, 1>();
  return pose;
}

std::optional<HeadPose> seen_by(const Camera& camera, std::span<const Vec3> from,
                                std::span<const Vec3> pixels, std::span<const double> weights) {
  constexpr int rounds = 30;
  Vec3 middle = Vec3::Zero();
  double sum = 0.0;
  size_t count = 0;
  for (size_t i = 0; i < from.size(); ++i)
    if (weights[i] > 0.0) {
      ++count;
      sum += weights[i];
      middle += weights[i] * from[i];
    }
  if (count < 4) return {};
  middle /= sum;
  HeadPose pose;
  Vec3 origin = Vec3::Zero();  // of `middle` in the camera, times 1 / depth, and the scale 1 / depth
  for (int round = 0; round < rounds; ++round) {
    // Rows of rotation / depth by least squares: u (1 + e) = I . a + u0, e the depth off the middle's.
    Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
    Eigen::Matrix<double, 4, 2> right = Eigen::Matrix<double, 4, 2>::Zero();
    for (size_t i = 0; i < from.size(); ++i) {
      if (!(weights[i] > 0.0)) continue;
      const Vec3 arm = from[i] - middle;
      const double off = round == 0 ? 0.0 : pose.rotation.row(2).dot(arm) * origin.z();
      const Eigen::Vector2d seen((pixels[i].x() - camera.centre_x) / camera.focal_x,
                                 (pixels[i].y() - camera.centre_y) / camera.focal_y);
      const Eigen::Vector4d row(arm.x(), arm.y(), arm.z(), 1.0);
      normal += weights[i] * row * row.transpose();
      right += weights[i] * row * ((1.0 + off) * seen).transpose();
    }
    const Eigen::LDLT<Eigen::Matrix4d> factor(normal);
    const Eigen::Vector4d spread = factor.vectorD();
    if (!(spread.minCoeff() > 1e-9 * spread.maxCoeff() * 1e-3)) return {};
    const Eigen::Matrix<double, 4, 2> found = factor.solve(right);
    const Vec3 first = found.col(0).head<3>(), second = found.col(1).head<3>();
    const double near = 0.5 * (first.norm() + second.norm());
    if (!std::isfinite(near) || !(near > 0.0)) return {};
    Mat3 rows;
    rows.row(0) = first.normalized().transpose();
    rows.row(1) = second.normalized().transpose();
    rows.row(2) = first.cross(second).normalized().transpose();
    pose.rotation = nearest_rotation(rows);
    origin = Vec3(found(3, 0), found(3, 1), near);
  }
  pose.translation = Vec3(origin.x(), origin.y(), 1.0) / origin.z() - pose.rotation * middle;
  return pose.translation.allFinite() ? std::optional(pose) : std::nullopt;
}

}  // namespace fascia::fit
