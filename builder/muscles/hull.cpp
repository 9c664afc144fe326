#include "builder/muscles/hull.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "geometry/error.h"

namespace fascia::muscles {

namespace {

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

/// Inner angle at corner `i`, in [−π/2, 3π/2); above π where the corner is reflex. The tip of a sliver has an
/// angle of nearly nothing, which rounding may turn below zero: counted as a full turn more, it would make
/// the sum over the corners jump by 2π.
double inner_angle(Carrier& carrier, const Hull& hull, int i) {
  const double angle = turn(hull.onward[i], hull.backward[i], carrier.normal(hull.corners[i]));
  return angle < -0.5 * M_PI ? angle + 2.0 * M_PI : angle;
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

/// `points` moved towards `middle` until they lie at `share` of their way from it.
std::vector<SurfacePoint> drawn_in(Carrier& carrier, const SurfacePoint& middle,
                                   const std::vector<SurfacePoint>& points, double share) {
  std::vector<SurfacePoint> drawn;
  for (const SurfacePoint& point : points) {
    const geodesics::Path& path = carrier.connect(middle, point);
    drawn.push_back(geodesics::point_along(carrier.surface, path, share * path.length));
  }
  return drawn;
}

/// Points just inside a chord of the layout may lie outside the geodesic where the surface is a saddle: they
/// become corners. `chosen` are those of `points` that are corners already.
void take_in_outlying(Carrier& carrier, const std::vector<SurfacePoint>& points,
                      const std::vector<int>& chosen, Hull& hull) {
  for (int i = 0; i < static_cast<int>(points.size()); ++i) {
    if (std::find(chosen.begin(), chosen.end(), i) != chosen.end()) continue;
    for (int k = 0; k < hull.size(); ++k) {
      const Vec3 offset = carrier.at(points[i]) - hull.positions[k];
      const double along = offset.dot(hull.onward[k]);
      if (along <= 0.0 || along >= hull.sides[k] ||
          (offset - along * hull.onward[k]).norm() > 0.1 * hull.sides[k])
        continue;
      const Vec3 direction = direction_at_start(carrier.connect(hull.corners[k], points[i]));
      if (turn(hull.onward[k], direction, carrier.normal(hull.corners[k])) > -1e-6) continue;
      hull.corners.insert(hull.corners.begin() + k + 1, points[i]);
      measure_sides(carrier, hull);
      break;
    }
  }
}

double turning_of(Carrier& carrier, const Hull& hull) {
  double turning = 0.0;
  for (int i = 0; i < hull.size(); ++i)
    turning += M_PI - inner_angle(carrier, hull, i);
  return turning;
}

/// The hull of three or more distinct points: the planar one in geodesic polar coordinates about `middle`,
/// mended where the surface's curvature makes a difference. `outline` receives the turning of what it was
/// before, which tells how much of the surface it goes round.
Hull hull_about(Carrier& carrier, const SurfacePoint& middle, const std::vector<SurfacePoint>& points,
                double& outline) {
  Hull hull;
  const std::vector<int> chosen = planar_hull(polar_layout(carrier, middle, points));
  for (int i : chosen)
    hull.corners.push_back(points[i]);
  measure_sides(carrier, hull);
  outline = hull.turning = 2.0 * M_PI;
  if (hull.size() < 3) return hull;
  outline = turning_of(carrier, hull);
  take_in_outlying(carrier, points, chosen, hull);
  while (remove_reflex(carrier, hull)) {
  }
  hull.turning = turning_of(carrier, hull);
  return hull;
}

/// Whether an outline around `points` with a total turning of `outline` radians has an interior: the exterior
/// angles of an outline around half of a closed surface sum to zero. For small regions the sum is unreliable,
/// but these cannot cover half of the surface.
bool has_inside(Carrier& carrier, const SurfacePoint& middle, const std::vector<SurfacePoint>& points,
                double outline) {
  constexpr double least_turning = 0.3, small = 0.25;  // radians; of the surface's diagonal
  if (outline >= least_turning) return true;
  double reach = 0.0;
  for (const SurfacePoint& corner : points)
    reach = std::max(reach, carrier.connect(middle, corner).length);
  return reach <= small * bounds(carrier.surface.mesh.vertices).size().norm();
}

}  // namespace

Vec3 Hull::middle() const {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& p : positions)
    sum += p;
  return sum / std::max(1, size());
}

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
  const std::vector<SurfacePoint> kept = distinct(carrier, points, merge);
  if (kept.empty()) throw Error(what + ": the region has no points");
  Hull hull;
  if (kept.size() <= 2) {
    hull.corners = kept;
    measure_sides(carrier, hull);
    hull.turning = 2.0 * M_PI;
    return hull;
  }
  Vec3 centre = Vec3::Zero();
  for (const SurfacePoint& point : kept)
    centre += carrier.at(point) / double(kept.size());
  const SurfacePoint middle = carrier.closest(centre);
  constexpr double step = 0.85, least = 0.1;
  for (double share = 1.0;; share *= step) {
    const std::vector<SurfacePoint> drawn =
        share < 1.0 ? distinct(carrier, drawn_in(carrier, middle, kept, share), merge) : kept;
    double outline = 0.0;
    hull = hull_about(carrier, middle, drawn, outline);
    hull.kept = share;
    if (has_inside(carrier, middle, drawn, outline) || share * step < least) return hull;
  }
}

}  // namespace fascia::muscles
