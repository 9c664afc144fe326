#include "builder/skull/jaw_frame.h"

#include <Eigen/Geometry>
#include <cmath>

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
  jaw.motion = generic.jaw;
  const double scale = std::cbrt(std::abs(turn.determinant()));
  for (double* length : {&jaw.motion.open_forward, &jaw.motion.open_down, &jaw.motion.protrusion_forward,
                         &jaw.motion.protrusion_down, &jaw.motion.lateral_glide})
    *length *= scale;
  return jaw;
}

}  // namespace fascia::skull
