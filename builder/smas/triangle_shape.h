#pragma once

#include <algorithm>
#include <cmath>

#include "geometry/mesh.h"

namespace fascia::smas {

/// Cosine of the smallest angle of triangle (a, b, c), the one opposite the shortest side; 1 when two corners
/// coincide.
inline double smallest_angle_cosine(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double x = (b - c).squaredNorm(), y = (c - a).squaredNorm(), z = (a - b).squaredNorm();
  const double least = std::min({x, y, z});
  const double beside = std::max(x, std::max(y, z)), middle = x + y + z - least - beside;
  const double product = beside * middle;
  return product > 0.0 ? 0.5 * (beside + middle - least) / std::sqrt(product) : 1.0;
}

/// Whether triangle (a, b, c) has area and faces within about 70 degrees of `facing`, of any length.
inline bool is_upright(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& facing) {
  const Vec3 u = b - a, v = c - a;
  const Vec3 facet(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]);
  const double along = facet.dot(facing);
  return along > 0.0 && along * along > 0.09 * facet.squaredNorm() * facing.squaredNorm();
}

}  // namespace fascia::smas
