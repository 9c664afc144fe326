#include "builder/muscles/hull.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "geometry/error.h"

namespace fascia::muscles {

namespace {

double cross(const Vec2& a, const Vec2& b) {
  return a[0] * b[1] - a[1] * b[0];
}

/// Geodesic polar coordinates of `points` about `middle`, laid out in the plane of its triangle.
std::vector<Vec2> polar_layout(Carrier& carrier, const SurfacePoint& middle,
                               const std::vector<SurfacePoint>& points) {
  const Vec3 normal = triangle_normal(carrier.surface.mesh, middle.triangle);
  const Vec3 x = normal.unitOrthogonal(), y = normal.cross(x);
  std::vector<Vec2> flat;
  for (const SurfacePoint& point : points) {
    const geodesics::Path& path = carrier.connect(middle, point);
    const Vec3 direction = direction_at_start(path);
    const Vec2 unit = Vec2(direction.dot(x), direction.dot(y)).normalized();
    flat.push_back(direction.isZero() ? Vec2(0.0, 0.0) : Vec2(path.length * unit));
  }
  return flat;
}

/// Angle from `a` counter-clockwise to `b` about `normal`, in (−π, π].
double turn(const Vec3& a, const Vec3& b, const Vec3& normal) {
  return std::atan2(a.cross(b).dot(normal), a.dot(b));
}

/// Fills the sides of a hull whose corners are set.
void measure_sides(Carrier& carrier, Hull& hull) {
  const int count = hull.size();
  hull.positions.resize(count);
  hull.onward.assign(count, Vec3::Zero());
  hull.backward.assign(count, Vec3::Zero());
  hull.sides.assign(count, 0.0);
  for (int i = 0; i < count; ++i)
    hull.positions[i] = carrier.at(hull.corners[i]);
  for (int i = 0; i < count && count > 1; ++i) {
    const int j = (i + 1) % count;
    const geodesics::Path& side = carrier.connect(hull.corners[i], hull.corners[j]);
    hull.onward[i] = direction_at_start(side);
    hull.backward[j] = direction_at_end(side);
    hull.sides[i] = side.length;
  }
}

/// Inner angle at corner `i`, in [0, 2π); above π where the corner is reflex.
double inner_angle(Carrier& carrier, const Hull& hull, int i) {
  const double angle = turn(hull.onward[i], hull.backward[i], carrier.normal(hull.corners[i]));
  return angle < 0.0 ? angle + 2.0 * M_PI : angle;
}

/// Removes the most reflex corner. Returns false when all are convex.
bool remove_reflex(Carrier& carrier, Hull& hull) {
  int worst = -1;
  double widest = M_PI + 1e-9;
  for (int i = 0; i < hull.size() && hull.size() > 3; ++i) {
    const double angle = inner_angle(carrier, hull, i);
    if (angle > widest) {
      widest = angle;
      worst = i;
    }
  }
  if (worst < 0) return false;
  hull.corners.erase(hull.corners.begin() + worst);
  measure_sides(carrier, hull);
  return true;
}

std::vector<SurfacePoint> distinct(Carrier& carrier, const std::vector<SurfacePoint>& points, double merge) {
  std::vector<SurfacePoint> kept;
  for (const SurfacePoint& point : points) {
    const bool known = std::any_of(kept.begin(), kept.end(), [&](const SurfacePoint& other) {
      return (carrier.at(other) - carrier.at(point)).norm() <= merge;
    });
    if (!known) kept.push_back(point);
  }
  return kept;
}

}  // namespace

std::vector<int> planar_hull(const std::vector<Vec2>& points) {
  std::vector<int> order(points.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    return std::make_pair(points[a][0], points[a][1]) < std::make_pair(points[b][0], points[b][1]);
  });
  std::vector<int> hull;
  const auto sweep = [&](int i, size_t base) {
    while (hull.size() >= base + 2 &&
           cross(points[hull.back()] - points[hull[hull.size() - 2]], points[i] - points[hull.back()]) <= 0.0)
      hull.pop_back();
    hull.push_back(i);
  };
  for (int i : order)
    sweep(i, 0);
  const size_t base = hull.size() - 1;
  for (size_t k = order.size() - 1; k-- > 0;)
    sweep(order[k], base);
  hull.pop_back();
  return hull;
}

const geodesics::Path& Carrier::connect(const SurfacePoint& from, const SurfacePoint& to) {
  geodesics::connect_into(surface, from, to, {}, workspace, path);
  return path;
}

Vec3 direction_at_start(const geodesics::Path& path) {
  for (size_t i = 1; i < path.positions.size(); ++i) {
    const Vec3 step = path.positions[i] - path.positions[0];
    if (step.norm() > 1e-9) return step.normalized();
  }
  return Vec3::Zero();
}

Vec3 direction_at_end(const geodesics::Path& path) {
  for (size_t i = path.positions.size(); i-- > 1;) {
    const Vec3 step = path.positions[i - 1] - path.positions.back();
    if (step.norm() > 1e-9) return step.normalized();
  }
  return Vec3::Zero();
}

Hull geodesic_hull(Carrier& carrier, const std::vector<SurfacePoint>& points, const std::string& what,
                   double merge) {
  Hull hull;
  const std::vector<SurfacePoint> kept = distinct(carrier, points, merge);
  if (kept.empty()) throw Error(what + ": the region has no points");
  if (kept.size() <= 2) {
    hull.corners = kept;
    measure_sides(carrier, hull);
    hull.turning = 2.0 * M_PI;
    return hull;
  }
  Vec3 centre = Vec3::Zero();
  for (const SurfacePoint& point : kept)
    centre += carrier.at(point) / double(kept.size());
  const std::vector<Vec2> flat = polar_layout(carrier, carrier.closest(centre), kept);
  std::vector<int> chosen = planar_hull(flat);
  for (int i : chosen)
    hull.corners.push_back(kept[i]);
  measure_sides(carrier, hull);
  if (hull.size() < 3) return hull;
  // Points just inside a chord of the layout may lie outside the geodesic where the surface is a saddle.
  for (int i = 0; i < static_cast<int>(kept.size()); ++i) {
    if (std::find(chosen.begin(), chosen.end(), i) != chosen.end()) continue;
    for (int k = 0; k < hull.size(); ++k) {
      const Vec3 offset = carrier.at(kept[i]) - hull.positions[k];
      const double along = offset.dot(hull.onward[k]);
      if (along <= 0.0 || along >= hull.sides[k] ||
          (offset - along * hull.onward[k]).norm() > 0.1 * hull.sides[k])
        continue;
      const Vec3 direction = direction_at_start(carrier.connect(hull.corners[k], kept[i]));
      if (turn(hull.onward[k], direction, carrier.normal(hull.corners[k])) > -1e-6) continue;
      hull.corners.insert(hull.corners.begin() + k + 1, kept[i]);
      measure_sides(carrier, hull);
      break;
    }
  }
  while (remove_reflex(carrier, hull)) {
  }
  for (int i = 0; i < hull.size(); ++i)
    hull.turning += M_PI - inner_angle(carrier, hull, i);
  // A sliver, such as a region pressed flat on the surface's rim, has no reliable angles: the size tells.
  double reach = 0.0;
  for (const Vec2& p : flat)
    reach = std::max(reach, p.norm());
  if (hull.turning < 0.3 && reach > 0.25 * bounds(carrier.surface.mesh.vertices).size().norm())
    throw Error(what +
                ": the region covers half of the surface or more, so it has no convex hull; make it smaller");
  return hull;
}

}  // namespace fascia::muscles
