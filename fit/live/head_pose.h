#pragma once

#include <optional>
#include <span>

#include "geometry/mesh.h"

namespace fascia::fit {

/// From the head's metres to the space in which it is observed: x -> scale rotation x + translation.
struct HeadPose {
  Mat3 rotation = Mat3::Identity();
  Vec3 translation = Vec3::Zero();
  double scale = 1.0;

  Vec3 operator*(const Vec3& place) const { return scale * (rotation * place) + translation; }
  /// From what is observed back to the head.
  Vec3 back(const Vec3& place) const { return rotation.transpose() * (place - translation) / scale; }
  /// A small motion in the head's own frame: a turn vector (radians), a shift (metres) and the logarithm of a
  /// growth, applied before the pose.
  void move(const Vec3& turn, const Vec3& shift, double growth);
};

/// A pinhole camera: x to the picture's right, y down, z away from it; lengths of the picture in pixels.
struct Camera {
  double focal_x = 1000.0, focal_y = 1000.0;
  double centre_x = 0.0, centre_y = 0.0;

  /// From a place before the camera to where the ray of `pixel` (x and y count) passes at the same depth.
  Vec3 across(const Vec3& pixel, const Vec3& place) const {
    return {(pixel.x() - centre_x) / focal_x * place.z() - place.x(),
            (pixel.y() - centre_y) / focal_y * place.z() - place.y(), 0.0};
  }
};

/// The pose that brings `from` nearest to `to` in weighted squared distance, by a rotation, a shift and, with
/// `may_scale`, a growth (see fascia::similarity). Weights are not negative. None when fewer than three
/// points count or they lie on a line.
std::optional<HeadPose> pose_between(std::span<const Vec3> from, std::span<const Vec3> to,
                                     std::span<const double> weights, bool may_scale);

/// The pose in which `camera` sees the places `from` at `pixels` (x and y count) by scaled orthography
/// (DeMenthon & Davis 1995, "Model-based object pose in 25 lines of code"), repeated with the depths found.
/// None when fewer than four points count or they lie in a plane.
std::optional<HeadPose> seen_by(const Camera& camera, std::span<const Vec3> from,
                                std::span<const Vec3> pixels, std::span<const double> weights);

}  // namespace fascia::fit
