#include "builder/rigging/zones.h"
#include "geometry/alignment.h"
#include "geometry/smoothstep.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace fascia::rigging {

namespace {

/// Distance of `p` from the polygon, 0 inside.
double distance_outside(const std::vector<Vec2>& outline, const Vec2& p) {
  bool inside = false;
  double nearest = 1e300;
  for (size_t i = 0, j = outline.size() - 1; i < outline.size(); j = i++) {
    const Vec2 &a = outline[j], &b = outline[i];
    if ((a[1] > p[1]) != (b[1] > p[1]) && p[0] < (b[0] - a[0]) * (p[1] - a[1]) / (b[1] - a[1]) + a[0])
      inside = !inside;
    const Vec2 side = b - a;
    const double length = side.squaredNorm();
    const double t = length > 0 ? std::clamp((p - a).dot(side) / length, 0.0, 1.0) : 0.0;
    nearest = std::min(nearest, (a + t * side - p).norm());
  }
  return inside ? 0.0 : nearest;
}

}  // namespace

ZoneField::ZoneField(const std::vector<anatomy::Zone>& zones, double otherwise, const splines::Warp& to_head)
    : otherwise_(otherwise) {
  for (const anatomy::Zone& zone : zones) {
    if (zone.polygon.size() < 3) continue;
    std::vector<Vec3> carried = to_head(zone.polygon);
    Area area;
    area.value = zone.value;
    area.falloff = std::max(zone.falloff, 1e-4);
    area.centre = Vec3::Zero();
    for (const Vec3& p : carried)
      area.centre += p / static_cast<double>(carried.size());
    double reach = 0.0;
    for (const Vec3& p : carried)
      reach = std::max(reach, (p - area.centre).norm());
    const Mat3 axes = principal_axes(scatter(carried)).axes;
    area.normal = axes.col(0);
    area.x = axes.col(2);
    area.y = axes.col(1);
    // The far side of the head is as near to the plane as the near one: a slab keeps it out.
    area.depth = 0.02 + 0.5 * reach;
    for (const Vec3& p : carried)
      area.outline.emplace_back((p - area.centre).dot(area.x), (p - area.centre).dot(area.y));
    areas_.push_back(std::move(area));
  }
}

double ZoneField::operator()(const Vec3& point) const {
  double sum = 0.0, weights = 0.0, strongest = 0.0;
  for (const Area& area : areas_) {
    const Vec3 from = point - area.centre;
    if (std::abs(from.dot(area.normal)) > area.depth) continue;
    const double outside = distance_outside(area.outline, Vec2(from.dot(area.x), from.dot(area.y)));
    if (outside >= area.falloff) continue;
    const double weight = smoothstep(1.0 - outside / area.falloff);
    sum += weight * area.value;
    weights += weight;
    strongest = std::max(strongest, weight);
  }
  return weights > 0.0 ? otherwise_ + strongest * (sum / weights - otherwise_) : otherwise_;
}

}  // namespace fascia::rigging
