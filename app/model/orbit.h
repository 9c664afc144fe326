#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>

#include "geometry/mesh.h"
#include "view/renderer.h"

namespace fascia::app {

/// A ray in the rig's frame.
struct Ray {
  Vec3 origin = Vec3::Zero(), direction = Vec3(0, 0, -1);  ///< direction of length 1
};

/// The camera of the viewport: it turns about a point of the head and glides to where it is sent.
class Orbit {
 public:
  /// Looks at `box` from the front, at once.
  void frame(const Bounds& box);

  /// Sends the camera to a named view of what it last framed: front, left, right, three-quarter, back, below.
  void go_to(const std::string& view);
  /// Sends it to look at `point` from `distance` metres, along `normal`; zero: from where it stands.
  void look_at(const Vec3& point, const Vec3& normal, double distance);

  void turn(double yaw_degrees, double pitch_degrees);
  /// Shifts the target by pixels of a viewport `height` pixels high.
  void shift(double right_pixels, double up_pixels, double height);
  /// Nearer by `factor` below 1.
  void zoom(double factor);

  /// Lets time pass; returns whether the camera has moved. With `at_once` a glide ends now.
  bool advance(double seconds, bool at_once);

  const view::Camera& camera() const { return now_; }

  /// The ray under a pixel of a viewport of `width` by `height`, from its top left corner.
  Ray ray(double x, double y, double width, double height) const;
  /// Where a point of the rig's frame is in the viewport, in pixels from its top left corner, and how far
  /// behind the camera's plane; nothing when it lies behind the camera.
  std::optional<Vec3> pixel(const Vec3& point, double width, double height) const;
  /// Metres a pixel at the distance of `point`.
  double metres_a_pixel(const Vec3& point, double height) const;
  Vec3 right() const;
  Vec3 up() const;
  Vec3 back() const;  ///< towards the camera
  Vec3 eye() const;

 private:
  view::Camera now_, goal_;
  Bounds box_;
};

}  // namespace fascia::app
