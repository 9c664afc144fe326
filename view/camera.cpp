#include "view/camera.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "geometry/error.h"

namespace fascia::view {

namespace {

Vec3 backward(const Camera& camera) {
  const double yaw = camera.yaw * EIGEN_PI / 180.0, pitch = camera.pitch * EIGEN_PI / 180.0;
  return {std::sin(yaw) * std::cos(pitch), std::sin(pitch), std::cos(yaw) * std::cos(pitch)};
}

}  // namespace

Camera named_camera(const std::string& view, const Bounds& box, double fill) {
  Camera camera;
  if (view == "front")
    camera.yaw = 0;
  else if (view == "side")
    camera.yaw = 90;
  else if (view == "right")
    camera.yaw = -90;
  else if (view == "three-quarter")
    camera.yaw = 38;
  else if (view == "back")
    camera.yaw = 180;
  else
    throw Error("view '" + view + "' is unknown: use front, side, right, three-quarter, back or turntable");
  camera.target = box.centre();
  const double height = std::max({box.size()[1], box.size()[0], 0.8 * box.size()[2]});
  camera.distance =
      0.5 * height / fill / std::tan(camera.field_of_view * EIGEN_PI / 360.0) + 0.35 * box.size()[2];
  return camera;
}

Vec3 eye_of(const Camera& camera) {
  return camera.target + camera.distance * backward(camera);
}

Mat4 eye_matrix(const Camera& camera) {
  const Vec3 back = backward(camera);
  // Straight from above or below, the picture's top is what lies to the back of the head.
  const Vec3 sky = std::abs(back[1]) > 0.9999 ? Vec3(0, 0, back[1] > 0 ? -1.0 : 1.0) : Vec3(Vec3::UnitY());
  const Vec3 right = sky.cross(back).normalized(), up = back.cross(right);
  Mat4 view = Mat4::Identity();
  view.row(0).head<3>() = right;
  view.row(1).head<3>() = up;
  view.row(2).head<3>() = back;
  view.topRightCorner<3, 1>() = -view.topLeftCorner<3, 3>() * eye_of(camera);
  return view;
}

Mat4 clip_matrix(const Camera& camera, double aspect) {
  const double near = 0.05 * camera.distance, far = 4.0 * camera.distance;
  const double f = 1.0 / std::tan(camera.field_of_view * EIGEN_PI / 360.0);
  Mat4 p = Mat4::Zero();
  p(0, 0) = f / aspect;
  p(1, 1) = f;
  p(2, 2) = (far + near) / (near - far);
  p(2, 3) = 2 * far * near / (near - far);
  p(3, 2) = -1;
  return p;
}

}  // namespace fascia::view
