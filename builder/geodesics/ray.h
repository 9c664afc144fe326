#pragma once

#include <algorithm>

#include "builder/geodesics/surface.h"

namespace fascia::geodesics {

inline double cross(const Vec2& a, const Vec2& b) { return a[0] * b[1] - a[1] * b[0]; }

/// a / b as complex numbers.
inline Vec2 divided(const Vec2& a, const Vec2& b) {
  return Vec2(a[0] * b[0] + a[1] * b[1], a[1] * b[0] - a[0] * b[1]) / b.squaredNorm();
}

/// A ray in the frame of `half_edge`, laid from (0,0) to (1,0) with its triangle above: the ray covers
/// `direction` a metre, so the frame's scale is part of it.
struct Ray {
  int half_edge = 0;
  Vec2 place = Vec2::Zero();
  Vec2 direction = Vec2::Zero();
};

/// The ray seen from the next half-edge of the same triangle.
inline Ray turned(const Surface& surface, const Ray& ray) {
  const Vec2 along = surface.apex[ray.half_edge] - Vec2(1.0, 0.0);
  return {Surface::next(ray.half_edge), divided(ray.place - Vec2(1.0, 0.0), along), divided(ray.direction, along)};
}

/// Where the ray is.
inline SurfacePoint surface_point(const Surface& surface, const Ray& ray) {
  const Vec2& apex = surface.apex[ray.half_edge];
  const double c = ray.place[1] / apex[1], b = ray.place[0] - c * apex[0];
  SurfacePoint point;
  point.triangle = ray.half_edge / 3;
  point.barycentric[ray.half_edge % 3] = 1.0 - b - c;
  point.barycentric[Surface::next(ray.half_edge) % 3] = b;
  point.barycentric[Surface::previous(ray.half_edge) % 3] = c;
  return point;
}

struct Hit {
  Ray ray;           // at the crossing, in the frame of the half-edge crossed
  double distance = 0.0;
};

/// Where the ray leaves the triangle, not through the side it lies on.
inline Hit leave(const Surface& surface, const Ray& ray) {
  const Vec2& apex = surface.apex[ray.half_edge];
  // The apex left of the ray, or a ray out of the frame's origin, which faces the third side.
  const bool right = ray.place.isZero(0.0) || cross(ray.direction, apex - ray.place) > 0.0;
  const Vec2 from = right ? Vec2(1.0, 0.0) : apex;
  const Vec2 along = right ? Vec2(apex - Vec2(1.0, 0.0)) : Vec2(-apex);
  const double whole = cross(ray.direction, along);
  Hit hit;
  hit.ray.half_edge = right ? Surface::next(ray.half_edge) : Surface::previous(ray.half_edge);
  hit.ray.direction = divided(ray.direction, along);
  if (whole <= 0.0) {  // grazing a side: rounding only, no distance
    hit.ray.place = Vec2(right ? 0.0 : 1.0, 0.0);
    return hit;
  }
  hit.distance = std::max(cross(from - ray.place, along) / whole, 0.0);
  hit.ray.place[0] = std::clamp(cross(ray.place - from, ray.direction) / cross(along, ray.direction), 0.0, 1.0);
  return hit;
}

}  // namespace fascia::geodesics
