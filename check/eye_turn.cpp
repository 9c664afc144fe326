#include "check/eye_turn.h"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

namespace fascia::check {

bool sphere_centre(const std::vector<Vec3>& vertices, Vec3& centre, double& radius) {
  if (vertices.size() < 12) return false;
  Vec3 middle = Vec3::Zero();
  for (const Vec3& p : vertices)
    middle += p / static_cast<double>(vertices.size());
  // |p|^2 = 2 p.c + k, least squares about the middle.
  Eigen::Matrix4d normal = Eigen::Matrix4d::Zero();
  Eigen::Vector4d right = Eigen::Vector4d::Zero();
  for (const Vec3& v : vertices) {
    const Vec3 p = v - middle;
    const Eigen::Vector4d row(2.0 * p.x(), 2.0 * p.y(), 2.0 * p.z(), 1.0);
    normal += row * row.transpose();
    right += row * p.squaredNorm();
  }
  const Eigen::JacobiSVD<Eigen::Matrix4d> svd(normal, Eigen::ComputeFullU | Eigen::ComputeFullV);
  if (!(svd.singularValues()[3] > 0.0)) return false;
  const Eigen::Vector4d solved = svd.solve(right);
  const double squared = solved[3] + solved.head<3>().squaredNorm();
  if (!(squared > 0.0)) return false;
  centre = middle + solved.head<3>();
  radius = std::sqrt(squared);
  double off = 0.0, extent = 0.0;
  for (const Vec3& p : vertices) {
    off += std::abs((p - centre).norm() - radius) / static_cast<double>(vertices.size());
    extent = std::max(extent, (p - middle).norm());
  }
  return off < 0.08 * radius && extent > 0.5 * radius;
}

EyeTurn eye_turn(const std::vector<Vec3>& rest, const std::vector<Vec3>& now, const Vec3& centre) {
  EyeTurn out;
  if (rest.size() < 3 || rest.size() != now.size()) return out;
  Eigen::Matrix3Xd from(3, rest.size()), to(3, rest.size());
  for (size_t v = 0; v < rest.size(); ++v) {
    from.col(static_cast<Eigen::Index>(v)) = rest[v];
    to.col(static_cast<Eigen::Index>(v)) = now[v];
  }
  const Mat4 motion = Eigen::umeyama(from, to, false);
  for (size_t v = 0; v < rest.size(); ++v)
    out.bent = std::max(out.bent, (transform_point(motion, rest[v]) - now[v]).norm());
  const Mat3 turn = motion.topLeftCorner<3, 3>();
  const Eigen::AngleAxisd rotation(turn);
  out.angle = rotation.angle();
  const Vec3 gaze = turn * Vec3::UnitZ();
  out.yaw = std::atan2(gaze.x(), gaze.z());
  out.pitch = std::asin(std::clamp(gaze.y(), -1.0, 1.0));
  // The centre moves on a circle about the axis; what it moves along the axis counts in full.
  const Vec3 moved = transform_point(motion, centre) - centre;
  const double along = moved.dot(rotation.axis()), across = (moved - along * rotation.axis()).norm();
  out.off_centre = std::hypot(along, out.angle > 0.02 ? across / (2.0 * std::sin(0.5 * out.angle)) : across);
  return out;
}

}  // namespace fascia::check
