#pragma once

#include <vector>

#include "geometry/mesh.h"

namespace fascia::check {

/// The motion of an eyeball.
struct EyeTurn {
  double yaw = 0.0, pitch = 0.0;  ///< radians: of straight ahead, to the subject's left and upward
  double angle = 0.0;             ///< radians altogether
  double off_centre = 0.0;        ///< metres from the eyeball's own centre to the axis it turned about
  double bent = 0.0;              ///< metres: largest distance from a rigid motion
};

/// Centre of the least squares sphere of `vertices`; nothing if they are flat or not part of a sphere.
bool sphere_centre(const std::vector<Vec3>& vertices, Vec3& centre, double& radius);

/// The motion from `rest` to `now`, vertex by vertex; `centre` is the eyeball's own.
EyeTurn eye_turn(const std::vector<Vec3>& rest, const std::vector<Vec3>& now, const Vec3& centre);

}  // namespace fascia::check
