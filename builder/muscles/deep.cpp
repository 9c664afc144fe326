#include <Eigen/Eigenvalues>
#include <algorithm>

#include "builder/muscles/parts.h"

namespace fascia::muscles {

namespace {

/// Direction in which `polygon` is widest across `axis`.
Vec3 widest_across(const std::vector<Vec3>& polygon, const Vec3& centre, const Vec3& axis) {
  Mat3 spread = Mat3::Zero();
  for (const Vec3& p : polygon) {
    const Vec3 d = (p - centre) - axis * axis.dot(p - centre);
    spread += d * d.transpose();
  }
  Vec3 widest = Eigen::SelfAdjointEigenSolver<Mat3>(spread).eigenvectors().col(2);
  // The sign is free: fix it, so that mirrored muscles and equal inputs come out alike.
  int largest = 0;
  for (int i = 1; i < 3; ++i)
    if (std::abs(widest[i]) > std::abs(widest[largest])) largest = i;
  return widest[largest] < 0.0 ? Vec3(-widest) : widest;
}

/// Middle of `polygon`'s outline where its extent along `direction` is divided `share` : 1 − share.
Vec3 slice(const std::vector<Vec3>& polygon, const Vec3& direction, double share) {
  double low = 1e300, high = -1e300;
  for (const Vec3& p : polygon) {
    low = std::min(low, direction.dot(p));
    high = std::max(high, direction.dot(p));
  }
  const double level = low + share * (high - low);
  Vec3 sum = Vec3::Zero();
  int found = 0;
  for (size_t i = 0; i < polygon.size(); ++i) {
    const Vec3 &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    const double a = direction.dot(p) - level, b = direction.dot(q) - level;
    if ((a <= 0.0) == (b <= 0.0)) continue;
    sum += p + (a / (a - b)) * (q - p);
    ++found;
  }
  if (found > 0) return sum / found;
  for (const Vec3& p : polygon) sum += p / double(polygon.size());
  return sum;
}

double extent(const std::vector<Vec3>& polygon, const Vec3& direction) {
  double low = 1e300, high = -1e300;
  for (const Vec3& p : polygon) {
    low = std::min(low, direction.dot(p));
    high = std::max(high, direction.dot(p));
  }
  return high - low;
}

/// Cubic through the points in order (centripetal Catmull–Rom would need no less code): corners cut by
/// subdividing and averaging, the points themselves kept.
std::vector<Vec3> rounded(const std::vector<Vec3>& corners) {
  if (corners.size() < 3) return corners;
  std::vector<Vec3> curve;
  for (size_t i = 0; i + 1 < corners.size(); ++i) {
    const Vec3& p = corners[i];
    const Vec3& q = corners[i + 1];
    const Vec3 in = i > 0 ? Vec3(0.5 * (q - corners[i - 1])) : Vec3(q - p);
    const Vec3 out = i + 2 < corners.size() ? Vec3(0.5 * (corners[i + 2] - p)) : Vec3(q - p);
    for (int k = 0; k < 8; ++k) {
      const double t = k / 8.0, u = 1.0 - t;
      curve.push_back(u * u * (1 + 2 * t) * p + t * t * (3 - 2 * t) * q + u * u * t * in - t * t * u * out);
    }
  }
  curve.push_back(corners.back());
  return curve;
}

/// Moves a point out of a bone it lies in, when the way out is short.
void leave_bones(const std::vector<const spatial::SurfaceQuery*>& bones, Vec3& point) {
  constexpr double kReach = 0.006, kGap = 0.0005;
  for (const spatial::SurfaceQuery* bone : bones) {
    const spatial::ClosestPoint closest = bone->closest(point, kReach);
    if (closest.found() && closest.signed_distance < 0.0) point = closest.position + kGap * closest.pseudonormal;
  }
}

}  // namespace

Vec3 Place::centre() const {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& p : polygon) sum += p / double(polygon.size());
  return sum;
}

std::vector<Fibre> lay_through_space(const Carrier& smas, const Course& course,
                                     const std::vector<const spatial::SurfaceQuery*>& bones, const Options& options) {
  const Vec3 from = course.origin.centre(), to = course.insertion.centre();
  const Vec3 axis = (to - from).normalized();
  const Vec3 across = widest_across(course.origin.polygon, from, axis);
  Vec3 across_end = widest_across(course.insertion.polygon, to, axis);
  if (across_end.dot(across) < 0.0) across_end = -across_end;
  // A round insertion has no widest direction of its own: follow the origin's.
  if (across_end.dot(across) < 0.5) across_end = across;
  const double width = 0.5 * (extent(course.origin.polygon, across) + extent(course.insertion.polygon, across_end));
  const int count = fibre_count(width, course.muscle.bundles, options);
  std::vector<Fibre> fibres;
  for (int i = 0; i < count; ++i) {
    const double s = (i + 0.5) / count;
    Vec3 begin = slice(course.origin.polygon, across, s), end = slice(course.insertion.polygon, across_end, s);
    if (course.origin.bone) begin = course.origin.bone->closest(begin).position;
    if (course.insertion.bone) end = course.insertion.bone->closest(end).position;
    std::vector<Vec3> corners = {begin};
    for (size_t k = 0; k < course.waypoints.size(); ++k) {
      const double share = double(k + 1) / double(course.waypoints.size() + 1);
      corners.push_back(course.waypoints[k] + (1.0 - share) * (begin - from) + share * (end - to));
    }
    corners.push_back(end);
    const std::vector<Vec3> curve = rounded(corners);
    std::vector<Vec3> line = resampled(curve, point_count(polyline_length(curve), options));
    Fibre fibre;
    fibre.bundle = i * course.muscle.bundles / count;
    for (size_t k = 0; k < line.size(); ++k) {
      if (k > 0 && k + 1 < line.size()) leave_bones(bones, line[k]);
      fibre.points.push_back(unbound(smas, line[k]));
    }
    fibres.push_back(std::move(fibre));
  }
  return fibres;
}

}  // namespace fascia::muscles
