#include "builder/geodesics/trace.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "builder/geodesics/ray.h"
#include "geometry/error.h"

namespace fascia::geodesics {

namespace {

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
    const bool on_edge = start.barycentric[Surface::previous(h) % 3] == 0.0 && start.barycentric[h % 3] > 0.0 &&
                         start.barycentric[Surface::next(h) % 3] > 0.0;
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

}  // namespace

TraceResult trace(const Surface& surface, const SurfacePoint& start_point, const Vec3& direction, double length,
                  const TraceOptions& options) {
  if (!(length >= 0.0) || !std::isfinite(length))
    throw Error("geodesic: a trace of length " + std::to_string(length) + " m; give a finite length of 0 or more");
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
  for (int e = 0; e < 2 && ray.direction[1] < 0.0; ++e) ray = turned(surface, ray);
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
    const bool at_origin = share < options.vertex_tolerance, at_target = share > 1.0 - options.vertex_tolerance;
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
      if (boundary || !leave_vertex(surface, corner, std::max(std::atan2(back[1], back[0]), 0.0) + 0.5 * whole, ray)) {
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
