#pragma once

#include <Eigen/Geometry>
#include <span>
#include <vector>

#include "geometry/mesh.h"

namespace fascia {

/// The similarity transform (scale, rotation, no reflection) from `source` to `target` by weighted least
/// squares, as a 4x4 matrix. `weights` may be empty. For one or two points, or coincident ones, undetermined
/// components are minimal: a translation only, or the smallest rotation. S. Umeyama. 1991.
Mat4 similarity(std::span<const Vec3> source, std::span<const Vec3> target,
                std::span<const double> weights = {});

/// As `similarity`, with scale 1.
Mat4 rigid_motion(std::span<const Vec3> source, std::span<const Vec3> target,
                  std::span<const double> weights = {});

/// The rotation R for which the trace of R^T `correlation` is largest: with the sum of to * from^T over pairs
/// of vectors, the least squares rotation of `from` onto `to`. W. Kabsch. 1976.
Mat3 nearest_rotation(const Mat3& correlation);

/// The smallest rotation that maps the direction of `from` to that of `to`; about an arbitrary perpendicular
/// axis if they are opposite. Neither may be zero.
Eigen::Quaterniond least_rotation(const Vec3& from, const Vec3& to);
Eigen::Quaternionf least_rotation(const Eigen::Vector3f& from, const Eigen::Vector3f& to);

/// Eigenvalues, ascending, of a symmetric matrix, and the unit eigenvectors as columns in the same order.
struct PrincipalAxes {
  Vec3 values;
  Mat3 axes;
};
PrincipalAxes principal_axes(const Mat3& symmetric);

/// The sum of (p - mean)(p - mean)^T over `points`, in the square of their unit; zero for none.
Mat3 scatter(std::span<const Vec3> points);

struct Sphere {
  Vec3 centre = Vec3::Zero();
  double radius = 0.0;
};

/// The sphere for which the sum of squares of |p - centre|^2 - radius^2 over `points` is least; radius 0 for
/// fewer than four points. For nearly coplanar points the radius is meaningless.
Sphere least_squares_sphere(std::span<const Vec3> points);

/// Root mean square of the distances of `points` from `sphere`.
double distance_rms(const Sphere& sphere, std::span<const Vec3> points);

}  // namespace fascia
