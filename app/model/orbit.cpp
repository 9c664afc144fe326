#include "app/model/orbit.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace fascia::app {

namespace {

constexpr double degree = EIGEN_PI / 180.0;
constexpr double glide_seconds = 0.09;  ///< time constant of a glide

/// The equal of `angle` that is nearest to `other`, degrees.
double nearest_turn(double angle, double other) {
  return angle + 360.0 * std::round((other - angle) / 360.0);
}

}  // namespace

void Orbit::frame(const Bounds& box) {
  box_ = box;
  now_ = goal_ = view::named_camera("front", box, 0.82);
}

void Orbit::go_to(const std::string& view) {
  const std::string name = view == "left" ? "side" : view == "below" ? "front" : view;
  const double distance = view::named_camera(name, box_, 0.82).distance;
  goal_ = view::named_camera(name, box_, 0.82);
  goal_.distance = distance;
  if (view == "below") goal_.pitch = -35.0;
  goal_.yaw = nearest_turn(goal_.yaw, now_.yaw);
}

void Orbit::look_at(const Vec3& point, const Vec3& normal, double distance) {
  goal_.target = point;
  goal_.distance = distance;
  if (normal.norm() < 1e-9) return;
  const Vec3 n = normal.normalized();
  goal_.pitch = std::clamp(std::asin(std::clamp(n[1], -1.0, 1.0)) / degree, -40.0, 40.0);
  goal_.yaw = nearest_turn(std::atan2(n[0], n[2]) / degree, now_.yaw);
}

void Orbit::turn(double yaw_degrees, double pitch_degrees) {
  goal_.yaw += yaw_degrees;
  goal_.pitch = std::clamp(goal_.pitch + pitch_degrees, -89.0, 89.0);
  now_.yaw = goal_.yaw;
  now_.pitch = goal_.pitch;
}

void Orbit::shift(double right_pixels, double up_pixels, double height) {
  const double metres = metres_a_pixel(goal_.target, height);
  goal_.target -= metres * (right_pixels * right() + up_pixels * up());
  now_.target = goal_.target;
}

void Orbit::zoom(double factor) {
  const double widest = std::max(4.0 * box_.size().norm(), 0.1);
  goal_.distance = std::clamp(goal_.distance * factor, 0.03, widest);
}

bool Orbit::advance(double seconds, bool at_once) {
  const double share = at_once ? 1.0 : 1.0 - std::exp(-seconds / glide_seconds);
  const view::Camera before = now_;
  const auto near = [&](double& value, double to, double enough) {
    value = std::abs(to - value) < enough ? to : value + share * (to - value);
  };
  near(now_.yaw, goal_.yaw, 0.01);
  near(now_.pitch, goal_.pitch, 0.01);
  near(now_.distance, goal_.distance, 1e-5);
  for (int k = 0; k < 3; ++k)
    near(now_.target[k], goal_.target[k], 1e-6);
  return before.yaw != now_.yaw || before.pitch != now_.pitch || before.distance != now_.distance ||
         before.target != now_.target;
}

Vec3 Orbit::back() const {
  const double yaw = now_.yaw * degree, pitch = now_.pitch * degree;
  return Vec3(std::sin(yaw) * std::cos(pitch), std::sin(pitch), std::cos(yaw) * std::cos(pitch));
}

Vec3 Orbit::right() const {
  return Vec3::UnitY().cross(back()).normalized();
}

Vec3 Orbit::up() const {
  return back().cross(right());
}

Vec3 Orbit::eye() const {
  return now_.target + now_.distance * back();
}

Ray Orbit::ray(double x, double y, double width, double height) const {
  const double half = std::tan(0.5 * now_.field_of_view * degree);
  const double across = (2.0 * x - width) / height * half, upward = (1.0 - 2.0 * y / height) * half;
  return {eye(), (across * right() + upward * up() - back()).normalized()};
}

std::optional<Vec3> Orbit::pixel(const Vec3& point, double width, double height) const {
  const Vec3 from = point - eye();
  const double depth = -from.dot(back());
  if (depth < 1e-4) return std::nullopt;
  const double scale = 0.5 * height / (std::tan(0.5 * now_.field_of_view * degree) * depth);
  return Vec3(0.5 * width + scale * from.dot(right()), 0.5 * height - scale * from.dot(up()), depth);
}

double Orbit::metres_a_pixel(const Vec3& point, double height) const {
  const double depth = std::max(-(point - eye()).dot(back()), 1e-3);
  return 2.0 * depth * std::tan(0.5 * now_.field_of_view * degree) / height;
}

}  // namespace fascia::app
