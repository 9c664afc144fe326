#pragma once

#include <span>

#include "geometry/mesh.h"

namespace fascia::skull {

/// The similarity (scale, rotation, no mirroring) that carries `source` to `target` with the least weighted
/// sum of squares, as a 4x4 matrix. `weights` may be empty. One or two points, or all at one spot, give what
/// they determine: a translation, or the least rotation. S. Umeyama. 1991.
Mat4 similarity(std::span<const Vec3> source, std::span<const Vec3> target,
                std::span<const double> weights = {});

/// As `similarity`, with scale 1.
Mat4 rigid(std::span<const Vec3> source, std::span<const Vec3> target, std::span<const double> weights = {});

/// `matrix` applied to `point`.
inline Vec3 transform(const Mat4& matrix, const Vec3& point) {
  return matrix.topLeftCorner<3, 3>() * point + matrix.topRightCorner<3, 1>();
}

}  // namespace fascia::skull
