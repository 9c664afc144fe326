#include "builder/geodesics/trace.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "builder/geodesics/cross.h"
#include "geometry/error.h"

namespace fascia::geodesics {

namespace {

Vec2 divided(const Vec2& a, const Vec2& b) {
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
Ray turned(const Surface& surface, const Ray& ray) {
  const Vec2 along = surface.apex[ray.half_edge] - Vec2(1.0, 0.0);
  return {Surface::next(ray.half_edge), divided(ray.place - Vec2(1.0, 0.0), along),
          divided(ray.direction, along)};
}

SurfacePoint surface_point(const Surface& surface, const Ray& ray) {
  const Vec2& apex = surface.apex[ray.half_edge];
  const double c = ray.place[1] / apex[1], b = ray.place[0] - c * apex[0];
  SurfacePoint point;
  point.triangle = ray.half_edge / 3;
  point.barycentric[ray.half_edge % 3] = 1.0 - b - c;
  point.barycentric[Surface::next(ray.half_edge) % 3] = b;
  point.barycentric[Surface::previous(ray.half_edge) % 3] = c;
  return point;
}

/// Ray from `start` along `direction`, in the frame of its triangle's first half-edge.
Ray first_ray(const Surface& surface, const SurfacePoint& start, const Vec3& direction) {
  const int h = 3 * start.triangle;
  const Triangle& corners = surface.mesh.triangles[start.triangle];
  const Vec3& origin = surface.mesh.vertices[corners[0]];
  const Vec3 u = surface.mesh.vertices[corners[1]] - origin;
  const Vec3 normal = u.cross(surface.mesh.vertices[corners[2]] - origin);
  const Vec3 in_plane = normal.squaredNorm() > 0.0
                            ? Vec3(direction - normal * (normal.dot(direction) / normal.squaredNorm()))
                            : direction;
  const Vec3 up = normal.cross(u).normalized();
  const Vec2 flat(in_plane.dot(u.normalized()), in_plane.dot(up));
  if (!(flat.norm() > 1e-12 * direction.norm()) || !flat.allFinite())
    throw Error("geodesic: the direction at triangle " + std::to_string(start.triangle) +
                " has no part in the surface; give one along it");
  const Vec3& w = start.barycentric;
  return {h, w[1] * Vec2(1.0, 0.0) + w[2] * surface.apex[h], flat.normalized() / surface.length[h]};
}

/// Continues from the vertex at the origin of `corner`, `angle` to the left of that half-edge, through
/// the fan around it. Returns false when the boundary is in the way.
bool leave_vertex(const Surface& surface, int corner, double angle, Ray& ray) {
  for (size_t guard = 0; guard <= surface.twin.size(); ++guard) {
    if (angle <= surface.angle[corner] + 1e-12) {
      ray.half_edge = corner;
      ray.place = Vec2(0.0, 0.0);
      ray.direction = Vec2(std::cos(angle), std::sin(angle)) / surface.length[corner];
      return true;
    }
    angle -= surface.angle[corner];
    corner = surface.twin[Surface::previous(corner)];
    if (corner < 0) return false;
  }
  return false;
}

/// Rotates a start on an edge or vertex into the triangle its direction points to.
bool enter_first_triangle(const Surface& surface, const SurfacePoint& start, Ray& ray) {
  for (int e = 0; e < 3; ++e, ray = turned(surface, ray)) {
    const int h = ray.half_edge;
    if (start.barycentric[h % 3] == 1.0) {
      double angle = std::atan2(ray.direction[1], ray.direction[0]);
      if (angle < 0.0) {
        // Turn clockwise until the direction is inside, then proceed from there.
        int corner = h;
        while (angle < -1e-12) {
          const int twin = surface.twin[corner];
          if (twin < 0) return false;
          corner = Surface::next(twin);
          angle += surface.angle[corner];
          if (corner == h) break;
        }
        return leave_vertex(surface, corner, std::max(angle, 0.0), ray);
      }
      return leave_vertex(surface, h, angle, ray);
    }
    const bool on_edge = start.barycentric[Surface::previous(h) % 3] == 0.0 &&
                         start.barycentric[h % 3] > 0.0 && start.barycentric[Surface::next(h) % 3] > 0.0;
    if (!on_edge) continue;
    ray.place[1] = 0.0;
    if (std::abs(ray.direction[1]) < 1e-12 * ray.direction.norm()) ray.direction[1] = 0.0;
    if (ray.direction[1] < 0.0) {
      if (surface.twin[h] < 0) return false;
      ray = {surface.twin[h], Vec2(1.0, 0.0) - ray.place, -ray.direction};
    }
    return true;
  }
  return true;
}

void append(const Surface& surface, const SurfacePoint& point, Path& path) {
  path.points.push_back(point);
  path.positions.push_back(position(surface.mesh, point));
}

struct Hit {
  Ray ray;  // at the crossing, in the frame of the half-edge crossed
  double distance = 0.0;
};

/// Where the ray leaves the triangle, not through the side it lies on.
Hit leave(const Surface& surface, const Ray& ray) {
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
  hit.ray.place[0] =
      std::clamp(cross(ray.place - from, ray.direction) / cross(along, ray.direction), 0.0, 1.0);
  return hit;
}

}  // namespace

TraceResult trace(const Surface& surface, const SurfacePoint& start_point, const Vec3& direction,
                  double length, const TraceOptions& options) {
  if (!(length >= 0.0) || !std::isfinite(length))
    throw Error("geodesic: a trace of length " + std::to_string(length) +
                " m; give a finite length of 0 or more");
  const SurfacePoint start = checked(surface, start_point);
  TraceResult result;
  Ray ray = first_ray(surface, start, direction);
  if (!enter_first_triangle(surface, start, ray)) {
    append(surface, start, result.path);
    append(surface, start, result.path);
    result.reached_boundary = true;
    return result;
  }
  append(surface, surface_point(surface, ray), result.path);
  // The first triangle has three sides to leave by: look from the one the ray points away from.
  for (int e = 0; e < 2 && ray.direction[1] < 0.0; ++e)
    ray = turned(surface, ray);
  double left = length;
  while (true) {
    const Hit hit = leave(surface, ray);
    if (hit.distance >= left || result.crossings >= options.maximum_crossings) {
      ray.place += left * ray.direction;
      append(surface, surface_point(surface, ray), result.path);
      break;
    }
    left -= hit.distance;
    const int crossed = hit.ray.half_edge, twin = surface.twin[crossed];
    const double share = hit.ray.place[0];
    const bool at_origin = share<options.vertex_tolerance, at_target = share> 1.0 - options.vertex_tolerance;
    if (at_origin || at_target || twin < 0) {
      append(surface, point_on_edge(crossed, at_origin ? 0.0 : at_target ? 1.0 : share), result.path);
      if (!at_origin && !at_target) {
        result.reached_boundary = true;
        break;
      }
      // Straight through the vertex: half of its angle to either side of the way in.
      ++result.vertices_passed;
      const int corner = at_origin ? crossed : Surface::next(crossed);
      const Vec2 back = at_origin ? Vec2(-hit.ray.direction)
                                  : Vec2(-divided(hit.ray.direction, surface.apex[crossed] - Vec2(1.0, 0.0)));
      bool boundary = false;
      const double whole = total_angle(surface, corner, &boundary);
      if (boundary ||
          !leave_vertex(surface, corner, std::max(std::atan2(back[1], back[0]), 0.0) + 0.5 * whole, ray)) {
        result.reached_boundary = true;
        break;
      }
      continue;
    }
    ++result.crossings;
    if (options.points) append(surface, point_on_edge(crossed, share), result.path);
    ray = {twin, Vec2(1.0 - share, 0.0), -hit.ray.direction};
  }
  result.path.length = result.reached_boundary ? length - left : length;
  return result;
}

}  // namespace fascia::geodesics
