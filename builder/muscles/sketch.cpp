#include <algorithm>
#include <cmath>
#include <cstdio>

#include "builder/muscles/hull.h"
#include "builder/muscles/parts.h"
#include "geometry/alignment.h"
#include "geometry/error.h"

namespace fascia::muscles {

namespace {

/// Farther than this from skin, SMAS and bones a point is off the head.
constexpr double kOffHead = 0.005;

std::string millimetres(double metres) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f mm", 1e3 * metres);
  return text;
}

double distance_to_head(const Vec3& point, const Inputs& inputs, const spatial::SurfaceQuery& smas) {
  double nearest = std::min(inputs.skin->closest(point).distance, smas.closest(point).distance);
  for (const spatial::SurfaceQuery* bone : {inputs.cranium, inputs.mandible})
    if (bone) nearest = std::min(nearest, bone->closest(point).distance);
  return nearest;
}

/// The points in the plane that fits them best.
std::vector<Vec2> flattened(const std::vector<Vec3>& points) {
  Vec3 middle = Vec3::Zero();
  for (const Vec3& p : points)
    middle += p / double(points.size());
  const Mat3 axes = principal_axes(scatter(points)).axes;
  std::vector<Vec2> flat;
  for (const Vec3& p : points)
    flat.emplace_back((p - middle).dot(axes.col(2)), (p - middle).dot(axes.col(1)));
  return flat;
}

bool cross_each_other(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  return cross(b - a, c - a) * cross(b - a, d - a) < 0.0 && cross(d - c, a - c) * cross(d - c, b - c) < 0.0;
}

void check_simple(const std::vector<Vec2>& curve, const std::string& what) {
  const size_t count = curve.size();
  for (size_t i = 0; i < count; ++i)
    for (size_t j = i + 2; j < count; ++j) {
      if (i == 0 && j + 1 == count) continue;  // neighbours at the closing point
      if (cross_each_other(curve[i], curve[i + 1], curve[j], curve[(j + 1) % count]))
        throw Error(what + ": the curve crosses itself after its points " + std::to_string(i + 1) + " and " +
                    std::to_string(j + 1) +
                    "; draw it once around the region, or give the points as \"points\"");
    }
}

/// The outline of `points`; what lies inside adds nothing to a region. Points in line stay as they are.
std::vector<Vec3> outline(const std::vector<Vec3>& points, const std::vector<Vec2>& flat) {
  std::vector<Vec3> region;
  for (int i : planar_hull(flat))
    region.push_back(points[static_cast<size_t>(i)]);
  return region.size() >= 3 ? region : points;
}

/// The sketch's points without those that lie on one another, and the same in their plane.
struct SoundPoints {
  std::vector<Vec3> points;
  std::vector<Vec2> flat;
};

void check_finite(const Sketch& sketch, size_t i, const std::string& what) {
  if (!sketch.points[i].allFinite())
    throw Error(what + ": point " + std::to_string(i + 1) + " is not three finite numbers");
}

SoundPoints sound_points(const Sketch& sketch, const std::string& what) {
  std::vector<Vec3> points;
  for (const Vec3& p : sketch.points) {
    const bool known =
        std::any_of(points.begin(), points.end(), [&](const Vec3& q) { return (p - q).norm() < 1e-4; });
    if (!known) points.push_back(p);
  }
  if (points.size() < 3)
    throw Error(what + ": " + std::to_string(points.size()) +
                " different points; a region needs three or more");
  const Vec3 extent = bounds(points).size();
  if (extent.norm() < 1e-3)
    throw Error(what + ": the region is only " + millimetres(extent.norm()) +
                " wide; draw one of some millimetres");
  std::vector<Vec2> flat = flattened(points);
  if (sketch.is_curve) check_simple(flat, what);
  return {std::move(points), std::move(flat)};
}

}  // namespace

void check_sketch(const Sketch& sketch, const std::string& what) {
  for (size_t i = 0; i < sketch.points.size(); ++i)
    check_finite(sketch, i, what);
  sound_points(sketch, what);
}

std::vector<Vec3> sketched_region(const Sketch& sketch, const Place& place, const Inputs& inputs,
                                  const spatial::SurfaceQuery& smas, const std::string& what) {
  for (size_t i = 0; i < sketch.points.size(); ++i) {
    check_finite(sketch, i, what);
    const double off = distance_to_head(sketch.points[i], inputs, smas);
    if (off > kOffHead)
      throw Error(what + ": point " + std::to_string(i + 1) + " lies " + millimetres(off) +
                  " off the head; place it on the skin, in the axes and units of the head file");
  }
  SoundPoints sound = sound_points(sketch, what);
  std::vector<Vec3> points = std::move(sound.points);
  if (!sketch.is_curve) points = outline(points, sound.flat);
  if (place.bone)
    for (Vec3& p : points)
      p = place.bone->closest(p).position;
  return points;
}

}  // namespace fascia::muscles
