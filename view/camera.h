#pragma once

#include <string>

#include "geometry/mesh.h"

namespace fascia::view {

/// A perspective camera that looks at `target` from `distance` metres, turned by `yaw` about +Y (0: from
/// the front, 90: at the subject's left side) and `pitch` upward, in degrees.
struct Camera {
  Vec3 target = Vec3::Zero();
  double distance = 1.0;
  double yaw = 0.0, pitch = 0.0;
  double field_of_view = 22.0;  ///< vertical, degrees
};

/// The camera of a named view (front, side, right, three-quarter, back) that frames `box`; `fill` is the
/// share of the picture's height that the box takes. Throws fascia::Error for another name.
Camera named_camera(const std::string& view, const Bounds& box, double fill = 0.9);

/// Where the camera is, metres.
Vec3 eye_of(const Camera& camera);

/// From the scene to the eye: +X right, +Y up, looking along -Z.
Mat4 eye_matrix(const Camera& camera);

/// From the eye to OpenGL's clip space, for a picture `aspect` times as wide as high.
Mat4 clip_matrix(const Camera& camera, double aspect);

}  // namespace fascia::view
