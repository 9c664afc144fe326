#pragma once

#include "geometry/mesh.h"

namespace fascia::geodesics {

/// z of the cross product: positive when `b` points to the left of `a`.
inline double cross(const Vec2& a, const Vec2& b) {
  return a[0] * b[1] - a[1] * b[0];
}

}  // namespace fascia::geodesics
