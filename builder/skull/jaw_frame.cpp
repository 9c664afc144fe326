#include "builder/skull/jaw_frame.h"

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

namespace fascia::skull {

JawFrame jaw_frame(const Generic& generic, const BoneMap& map, const Mat4& pose) {
  JawFrame jaw;
  jaw.condyle_left = map(generic.condyle_left);
  jaw.condyle_right = map(generic.condyle_right);
  jaw.origin = 0.5 * (jaw.condyle_left + jaw.condyle_right);
  const Vec3 across = jaw.condyle_left - jaw.condyle_right;
  const Mat3 turn = pose.topLeftCorner<3, 3>();
  jaw.hinge = across.norm() > 1e-6 ? Vec3(across.normalized()) : Vec3((turn * Vec3::UnitX()).normalized());
  const Vec3 front = (turn * Vec3::UnitZ()).normalized();
  jaw.forward = (front - front.dot(jaw.hinge) * jaw.hinge).normalized();
  // The articular eminence slopes about 35 degrees down from the Frankfort plane.
  jaw.glide = Eigen::AngleAxisd(35 * std::numbers::pi / 180, jaw.hinge) * jaw.forward;
  const double scale = std::cbrt(std::abs(turn.determinant()));
  jaw.glide_limit *= scale;
  jaw.forward_limit *= scale;
  jaw.lateral_limit *= scale;
  return jaw;
}

}  // namespace fascia::skull
