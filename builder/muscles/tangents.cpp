#include "builder/muscles/tangents.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace fascia::muscles {

namespace {

std::vector<Vec2> flatten(const Hull& hull, const Vec3& origin, const Vec3& x, const Vec3& y) {
  std::vector<Vec2> flat;
  for (const Vec3& p : hull.positions)
    flat.emplace_back((p - origin).dot(x), (p - origin).dot(y));
  return flat;
}

/// True when all of `hull` lies on `side` of the line from `from` along `direction`, or on it.
bool keeps_side(const std::vector<Vec2>& hull, const Vec2& from, const Vec2& direction, HullSide side,
                double slack) {
  for (const Vec2& p : hull) {
    const double left = cross(direction, p - from);
    if (side == HullSide::right ? left > slack : left < -slack) return false;
  }
  return true;
}

/// The tangent of the two outlines in a plane; the longest of several that coincide in line.
std::optional<Tangent> planar_tangent(const std::vector<Vec2>& first, const std::vector<Vec2>& second,
                                      HullSide first_side, HullSide second_side) {
  std::optional<Tangent> found;
  for (size_t i = 0; i < first.size(); ++i)
    for (size_t j = 0; j < second.size(); ++j) {
      const Vec2 direction = second[j] - first[i];
      const double length = direction.norm();
      if (length < 1e-9) continue;
      const double slack = 1e-9 * length;
      if (!keeps_side(first, first[i], direction, first_side, slack) ||
          !keeps_side(second, first[i], direction, second_side, slack))
        continue;
      // Of points in line the nearest to each other are the tangent's ends.
      if (!found || length < found->length) found = Tangent{int(i), int(j), length};
    }
  return found;
}

/// The neighbour of corner `i` that lies on the wrong side of `direction`, or -1.
int wrong_neighbour(Carrier& carrier, const Hull& hull, int i, const Vec3& direction, HullSide side) {
  if (hull.size() < 2 || direction.isZero()) return -1;
  const Vec3 normal = carrier.normal(hull.corners[i]);
  const double sign = side == HullSide::right ? 1.0 : -1.0;
  const double onward = sign * direction.cross(hull.onward[i]).dot(normal);
  const double backward = sign * direction.cross(hull.backward[i]).dot(normal);
  if (std::max(onward, backward) <= 1e-6) return -1;
  const int count = hull.size();
  return onward >= backward ? (i + 1) % count : (i + count - 1) % count;
}

Arc walk(const Hull& hull, int from, int to, int step) {
  Arc arc = {from};
  const int count = hull.size();
  for (int i = from; i != to;) {
    i = (i + step + count) % count;
    arc.push_back(i);
  }
  return arc;
}

}  // namespace

std::optional<Tangent> mutual_tangent(Carrier& carrier, const Hull& first, const Hull& second,
                                      HullSide first_side, HullSide second_side) {
  const Vec3 a = first.middle(), b = second.middle();
  Vec3 normal = carrier.normal(carrier.closest(a)) + carrier.normal(carrier.closest(b));
  Vec3 x = b - a;
  x -= normal * (normal.dot(x) / std::max(normal.squaredNorm(), 1e-12));
  if (x.norm() < 1e-9) x = normal.unitOrthogonal();
  x.normalize();
  const Vec3 y = normal.cross(x).normalized();
  std::optional<Tangent> tangent =
      planar_tangent(flatten(first, a, x, y), flatten(second, a, x, y), first_side, second_side);
  if (!tangent) return std::nullopt;
  for (int steps = 0; steps < 2 * (first.size() + second.size()); ++steps) {
    const geodesics::Path& path = carrier.connect(first.corners[tangent->a], second.corners[tangent->b]);
    tangent->length = path.length;
    const Vec3 out = direction_at_start(path), in = -direction_at_end(path);
    const int next_a = wrong_neighbour(carrier, first, tangent->a, out, first_side);
    const int next_b = wrong_neighbour(carrier, second, tangent->b, in, second_side);
    if (next_a < 0 && next_b < 0) break;
    if (next_a >= 0) tangent->a = next_a;
    if (next_b >= 0) tangent->b = next_b;
  }
  return tangent;
}

FacingArcs facing_arcs(const Hull& first, const Hull& second, const Tangent& left, const Tangent& right) {
  FacingArcs arcs;
  arcs.first_near = walk(first, right.a, left.a, 1);
  arcs.first_far = walk(first, right.a, left.a, -1);
  arcs.second_near = walk(second, right.b, left.b, -1);
  arcs.second_far = walk(second, right.b, left.b, 1);
  return arcs;
}

double arc_length(const Hull& hull, const Arc& arc) {
  double sum = 0.0;
  for (size_t k = 0; k + 1 < arc.size(); ++k)
    sum += (hull.positions[arc[k + 1]] - hull.positions[arc[k]]).norm();
  return sum;
}

Vec3 along_arc(const Hull& hull, const Arc& arc, double fraction) {
  double left = fraction * arc_length(hull, arc);
  for (size_t k = 0; k + 1 < arc.size(); ++k) {
    const Vec3 &p = hull.positions[arc[k]], &q = hull.positions[arc[k + 1]];
    const double step = (q - p).norm();
    if (left <= step && step > 0.0) return p + (left / step) * (q - p);
    left -= step;
  }
  return hull.positions[arc.back()];
}

}  // namespace fascia::muscles
