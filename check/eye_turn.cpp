#include "check/eye_turn.h"
#include "geometry/alignment.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace fascia::check {

bool sphere_centre(const std::vector<Vec3>& vertices, Vec3& centre, double& radius) {
  if (vertices.size() < 12) return false;
  const Sphere sphere = least_squares_sphere(vertices);
  if (!(sphere.radius > 0.0)) return false;
  centre = sphere.centre;
  radius = sphere.radius;
  Vec3 middle = Vec3::Zero();
  for (const Vec3& p : vertices)
    middle += p / static_cast<double>(vertices.size());
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
  const Mat4 motion = rigid_motion(rest, now);
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
