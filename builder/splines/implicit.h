#pragma once

// Surfaces and curves as the zero set of a spline, negative inside.
//
// This work is based on:
// G. Turk, J. O'Brien. Shape transformation using variational implicit functions. 1999
// I. Macedo, J. Gois, L. Velho. Hermite radial basis functions implicits. 2011

#include <optional>
#include <span>

#include "builder/splines/polyharmonic.h"

namespace fascia::splines {

struct ImplicitOptions {
  int dimension = 3;    ///< 2: a curve in the plane
  double exponent = 3;  ///< Hermite: above 2
  int degree = -1;
  double lambda = 0;
  /// Variational: distance of the extra sites inward along the normals, in the user's unit, where the value
  /// is -1; 0 picks a hundredth of the extent.
  double offset = 0;
};

/// Turk and O'Brien: 0 at the points, -1 at as many points inside. Throws Error when counts differ or a
/// normal is zero.
Spline fit_variational(std::span<const Vec3> points, std::span<const Vec3> normals,
                       const ImplicitOptions& options = {});

/// 0 at the points with the unit outward normals as gradients: no offset to choose, and near the surface the
/// value is the distance. Errors as above.
Spline fit_hermite(std::span<const Vec3> points, std::span<const Vec3> normals,
                   const ImplicitOptions& options = {});

/// First zero of `field` on the ray from `origin` along `direction`, up to `range` in the user's unit: the
/// ray is walked in `steps` equal steps, and the first change of sign is closed in on to rounding.
std::optional<Vec3> trace(const Spline& field, const Vec3& origin, const Vec3& direction, double range,
                          int steps = 256);

/// The point where Newton steps along the gradient from `point` reach the zero set; nothing when they do not
/// within 50 steps.
std::optional<Vec3> project(const Spline& field, const Vec3& point);

/// Curvatures of the zero set at one of its points (exponent > 3): principal ones positive where the
/// surface bends away from its gradient, as a sphere's that grows outward. In 2D both are the curve's.
struct LevelCurvature {
  double gaussian = 0, mean = 0;
};
LevelCurvature level_curvature(const Spline& field, const Vec3& point);

}  // namespace fascia::splines
