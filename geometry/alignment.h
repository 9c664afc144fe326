#pragma once

#include <Eigen/Geometry>
#include <span>
#include <vector>

#include "geometry/mesh.h"

namespace fascia {

/// The similarity (scale, rotation, no mirroring) that carries `source` to `target` with the least weighted
/// sum of squares, as a 4x4 matrix. `weights` may be empty. One or two points, or all at one spot, give what
/// they determine: a translation, or the least rotation. S. Umeyama. 1991.
Mat4 similarity(std::span<const Vec3> source, std::span<const Vec3> target,
                std::span<const double> weights = {});

/// As `similarity`, with scale 1.
Mat4 rigid_motion(std::span<const Vec3> source, std::span<const Vec3> target,
                  std::span<const double> weights = {});

/// The rotation R for which the trace of R^T `correlation` is largest: with the sum of to * from^T over pairs
/// of vectors, the one that turns `from` onto `to` best. W. Kabsch. 1976.
Mat3 nearest_rotation(const Mat3& correlation);

/// The least rotation that turns the direction of `from` into that of `to`; about any axis across them where
/// they point opposite ways. Neither may be zero.
Eigen::Quaterniond least_rotation(const Vec3& from, const Vec3& to);
Eigen::Quaternionf least_rotation(const Eigen::Vector3f& from, const Eigen::Vector3f& to);

/// Eigenvalues, ascending, of a symmetric matrix, and unit eigenvectors in columns alike.
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
/// fewer than four points. Points in a plane or nearly so give a radius of no meaning.
Sphere least_squares_sphere(std::span<const Vec3> points);

/// Root mean square of the distances of `points` from `sphere`.
double distance_rms(const Sphere& sphere, std::span<const Vec3> points);

}  // namespace fascia
