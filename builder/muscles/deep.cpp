#include <algorithm>
#include <utility>

#include "builder/muscles/order.h"
#include "builder/muscles/parts.h"
#include "geometry/alignment.h"

namespace fascia::muscles {

namespace {

/// Direction in which `polygon` is widest across `axis`.
Vec3 widest_across(const std::vector<Vec3>& polygon, const Vec3& centre, const Vec3& axis) {
  Mat3 spread = Mat3::Zero();
  for (const Vec3& p : polygon) {
    const Vec3 d = (p - centre) - axis * axis.dot(p - centre);
    spread += d * d.transpose();
  }
  Vec3 widest = principal_axes(spread).axes.col(2);
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
  for (const Vec3& p : polygon)
    sum += p / double(polygon.size());
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
    if (closest.found() && closest.signed_distance < 0.0)
      point = closest.position + kGap * closest.pseudonormal;
  }
}

/// The directions along which the fibres stand in a row at either end. A region that is narrow against the
/// other, or turned far from it, follows the other's: so the sheet is not twisted.
std::pair<Vec3, Vec3> directions_across(const Course& course, const Vec3& from, const Vec3& to) {
  const Vec3 axis = (to - from).normalized();
  Vec3 begin = widest_across(course.origin.polygon, from, axis),
       end = widest_across(course.insertion.polygon, to, axis);
  if (end.dot(begin) < 0.0) end = -end;
  if (end.dot(begin) >= 0.5) return {begin, end};
  const bool insertion_is_wider =
      extent(course.insertion.polygon, end) > 1.5 * extent(course.origin.polygon, begin);
  return insertion_is_wider ? std::make_pair(end, end) : std::make_pair(begin, begin);
}

}  // namespace

Vec3 Place::centre() const {
  Vec3 sum = Vec3::Zero();
  for (const Vec3& p : polygon)
    sum += p / double(polygon.size());
  return sum;
}

std::vector<Fibre> lay_through_space(const Carrier& smas, const Course& course,
                                     const std::vector<const spatial::SurfaceQuery*>& bones,
                                     const Options& options) {
  const Vec3 from = course.origin.centre(), to = course.insertion.centre();
  const auto [across, across_end] = directions_across(course, from, to);
  const double width =
      0.5 * (extent(course.origin.polygon, across) + extent(course.insertion.polygon, across_end));
  const int count = fibre_count(width, course.muscle, options);
  std::vector<Fibre> fibres;
  for (int i = 0; i < count; ++i) {
    const double s = (i + 0.5) / count;
    Vec3 begin = slice(course.origin.polygon, across, s),
         end = slice(course.insertion.polygon, across_end, s);
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
  put_in_order(fibres, smas.query, [&](const Vec3& position, double) {
    Vec3 place = position;
    leave_bones(bones, place);
    return unbound(smas, place);
  });
  return fibres;
}

}  // namespace fascia::muscles
