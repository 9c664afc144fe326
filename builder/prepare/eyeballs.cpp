#include "builder/prepare/eyeballs.h"

#include <algorithm>
#include <bitset>
#include <cmath>

#include "geometry/alignment.h"

namespace fascia::prepare {

namespace {

/// Directions in 2 x 2 cells on each face of a cube: coarse, for eyeballs of games have few vertices.
size_t direction_cell(const Vec3& d) {
  Eigen::Index axis;
  d.cwiseAbs().maxCoeff(&axis);
  const auto side = static_cast<size_t>(2 * axis + (d[axis] > 0 ? 1 : 0));
  return 4 * side + (d[(axis + 1) % 3] > 0 ? 2 : 0) + (d[(axis + 2) % 3] > 0 ? 1 : 0);
}

/// The middle of what stands out of the sphere in front, where that is one cap.
std::optional<Vec3> cornea_axis(const Eyeball& ball, const std::vector<Vec3>& points) {
  // The sphere is fitted to the cornea too: the sclera's own radius is the median distance.
  std::vector<double> distances;
  for (const Vec3& p : points)
    distances.push_back((p - ball.centre).norm());
  const auto middle = distances.begin() + static_cast<std::ptrdiff_t>(distances.size() / 2);
  std::nth_element(distances.begin(), middle, distances.end());
  const double sclera = *middle;
  double highest = 0.0;
  for (const Vec3& p : points)
    if (p[2] > ball.centre[2]) highest = std::max(highest, (p - ball.centre).norm() - sclera);
  if (highest < 0.03 * sclera) return std::nullopt;
  Vec3 sum = Vec3::Zero();
  double total = 0.0;
  for (const Vec3& p : points) {
    const Vec3 from = p - ball.centre;
    const double weight = from.norm() - sclera - 0.4 * highest;
    if (weight <= 0.0 || from[2] <= 0.0) continue;
    sum += weight * from.normalized();
    total += weight;
  }
  const bool is_one_cap = sum.norm() > 0.8 * total;  // an optic nerve behind or a ring of folds is none
  return is_one_cap ? std::optional<Vec3>(sum.normalized()) : std::nullopt;
}

/// Balls made of rings have a pole where the triangles of the last ring meet; it lies in the pupil.
std::optional<Vec3> pole_axis(const Eyeball& ball, const std::vector<Vec3>& points,
                              const std::vector<Triangle>& triangles) {
  std::vector<int> meeting(points.size(), 0);
  for (const Triangle& t : triangles)
    for (int v : t)
      ++meeting[static_cast<size_t>(v)];
  int most = 0;
  std::optional<Vec3> axis;
  for (size_t v = 0; v < points.size(); ++v) {
    const Vec3 from = points[v] - ball.centre;
    if (from[2] < 0.5 * ball.radius || meeting[v] <= most) continue;
    most = meeting[v];
    axis = from.normalized();
  }
  return most >= 10 ? axis : std::nullopt;
}

}  // namespace

Eyeball fit_sphere(const std::vector<Vec3>& points, double* rms) {
  const Sphere sphere = least_squares_sphere(points);
  if (rms) *rms = distance_rms(sphere, points);
  Eyeball ball;
  ball.centre = sphere.centre;
  ball.radius = sphere.radius;
  return ball;
}

std::optional<RoundPart> round_part(const std::vector<Vec3>& points, const Vec3& lids, double width) {
  if (points.size() < 20) return std::nullopt;
  double rms = 0.0;
  RoundPart part;
  part.ball = fit_sphere(points, &rms);
  const Eyeball& ball = part.ball;
  if (!(rms < 0.12 * ball.radius) || ball.radius < 0.2 * width || ball.radius > 1.1 * width ||
      (ball.centre - lids).norm() > width || ball.centre.z() > lids.z() + 0.3 * ball.radius)
    return std::nullopt;
  std::bitset<24> covered;
  for (const Vec3& p : points)
    covered.set(direction_cell(p - ball.centre));
  part.coverage = static_cast<double>(covered.count()) / 24.0;
  return part;
}

Eyeball globe_behind(const Bounds& plate, double width) {
  Eyeball globe;  // a fissure is some 30 mm wide before a globe of 24 mm
  globe.radius = std::max(0.4 * width, 0.55 * plate.size().x());
  globe.centre = plate.centre();
  globe.centre.z() = plate.upper.z() - globe.radius;
  return globe;
}

Vec3 gaze_axis(const Eyeball& ball, const std::vector<Vec3>& points, const std::vector<Triangle>& triangles) {
  if (points.empty()) return Vec3::UnitZ();
  if (const auto axis = cornea_axis(ball, points)) return *axis;
  if (const auto axis = pole_axis(ball, points, triangles)) return *axis;
  return Vec3::UnitZ();
}

}  // namespace fascia::prepare
