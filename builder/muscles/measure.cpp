#include <Eigen/Geometry>
#include <algorithm>

#include "builder/muscles/order.h"

namespace fascia::muscles {

namespace {

/// The place a share of the way along the points, which are evenly spaced.
Vec3 along(const std::vector<FibrePoint>& points, double share) {
  const double place = share * double(points.size() - 1);
  const size_t n = std::min(static_cast<size_t>(place), points.size() - 2);
  return points[n].position + (place - double(n)) * (points[n + 1].position - points[n].position);
}

double mean_distance(const Fibre& a, const Fibre& b) {
  constexpr int samples = 9;
  double sum = 0.0;
  for (int k = 0; k < samples; ++k) {
    const double share = double(k) / (samples - 1);
    sum += (along(a.points, share) - along(b.points, share)).norm() / samples;
  }
  return sum;
}

/// A fibre with the direction each of its points is seen along.
struct SeenFibre {
  const std::vector<FibrePoint>& points;
  const std::vector<Vec3>& normals;
};

/// Normal of the sheet the fibres span as a whole.
Vec3 sheet_normal(const std::vector<Fibre>& fibres) {
  const auto &first = fibres.front().points, &last = fibres.back().points;
  Vec3 sum = Vec3::Zero();
  for (int k = 0; k + 1 < 9; ++k) {
    const double here = k / 8.0, next = (k + 1) / 8.0;
    const Vec3 step = along(first, next) - along(first, here) + along(last, next) - along(last, here);
    const Vec3 across = along(last, here) - along(first, here);
    const Vec3 normal = step.cross(across);
    // Fans whose fibres change sides would cancel out: keep the sign of the first.
    sum += sum.dot(normal) < 0.0 ? Vec3(-normal) : normal;
  }
  return sum.normalized();
}

/// Fibres lie side by side in their order: one that crosses a farther one crosses those between as well.
constexpr size_t kNeighbours = 4;

bool segments_cross(const SeenFibre& a, size_t k, const SeenFibre& b, size_t l) {
  const Vec3 p = a.points[k].position, q = a.points[k + 1].position;
  const Vec3 r = b.points[l].position, s = b.points[l + 1].position;
  const Vec3 normal = (a.normals[k] + a.normals[k + 1] + b.normals[l] + b.normals[l + 1]).normalized();
  const auto side = [&](const Vec3& from, const Vec3& to, const Vec3& point) {
    return (to - from).cross(point - from).dot(normal);
  };
  // A thousandth of a square millimetre: ends that meet and fibres laid on each other do not cross.
  constexpr double least = 1e-9;
  const auto opposite = [](double x, double y) {
    return (x > least && y < -least) || (x < -least && y > least);
  };
  return opposite(side(p, q, r), side(p, q, s)) && opposite(side(r, s, p), side(r, s, q));
}

/// Longest step between two points of a fibre.
double longest_step(const std::vector<FibrePoint>& points) {
  double longest = 1e-9;
  for (size_t k = 0; k + 1 < points.size(); ++k)
    longest = std::max(longest, (points[k + 1].position - points[k].position).norm());
  return longest;
}

int crossings_of(const SeenFibre& a, const SeenFibre& b) {
  const double step_a = longest_step(a.points), step_b = longest_step(b.points), reach = step_a + step_b;
  int count = 0;
  for (size_t k = 0; k + 1 < a.points.size(); ++k)
    for (size_t l = 0; l + 1 < b.points.size();) {
      // Skip as many segments as the gap guarantees.
      const double apart = (a.points[k].position - b.points[l].position).norm();
      if (apart > reach) {
        l += 1 + static_cast<size_t>((apart - reach) / step_b);
        continue;
      }
      count += segments_cross(a, k, b, l);
      ++l;
    }
  return count;
}

}  // namespace

std::vector<std::vector<Vec3>> seen_along(const std::vector<Fibre>& fibres,
                                          const spatial::SurfaceQuery& smas) {
  bool on_smas = false;
  for (const Fibre& fibre : fibres)
    for (const FibrePoint& point : fibre.points)
      on_smas = on_smas || point.bound;
  const Vec3 normal = on_smas || fibres.size() < 2 ? Vec3(0, 0, 1) : sheet_normal(fibres);
  std::vector<std::vector<Vec3>> all;
  for (const Fibre& fibre : fibres) {
    all.emplace_back();
    for (const FibrePoint& point : fibre.points)
      all.back().push_back(on_smas ? smas.smooth_normal(point.smas) : normal);
  }
  return all;
}

int crossings(const std::vector<Fibre>& fibres, const spatial::SurfaceQuery& smas) {
  std::vector<SeenFibre> seen;
  const auto normals = seen_along(fibres, smas);
  for (size_t i = 0; i < fibres.size(); ++i)
    seen.push_back({fibres[i].points, normals[i]});
  int count = 0;
  for (size_t i = 0; i < seen.size(); ++i)
    for (size_t j = i + 1; j < std::min(seen.size(), i + 1 + kNeighbours); ++j)
      count += crossings_of(seen[i], seen[j]);
  return count;
}

void measure(Muscle& muscle) {
  muscle.mean_length = muscle.longest = muscle.area = 0.0;
  muscle.shortest = muscle.fibres.empty() ? 0.0 : 1e300;
  for (Fibre& fibre : muscle.fibres) {
    fibre.rest_length = 0.0;
    for (size_t k = 0; k + 1 < fibre.points.size(); ++k)
      fibre.rest_length += (fibre.points[k + 1].position - fibre.points[k].position).norm();
    muscle.mean_length += fibre.rest_length / double(muscle.fibres.size());
    muscle.shortest = std::min(muscle.shortest, fibre.rest_length);
    muscle.longest = std::max(muscle.longest, fibre.rest_length);
  }
  // Strips between neighbouring fibres; half a strip more on either edge, as fibres stand for a width.
  for (size_t i = 0; i + 1 < muscle.fibres.size(); ++i) {
    const Fibre &a = muscle.fibres[i], &b = muscle.fibres[i + 1];
    muscle.area += mean_distance(a, b) * 0.5 * (a.rest_length + b.rest_length);
  }
  if (muscle.fibres.size() > 1)
    muscle.area *= double(muscle.fibres.size()) / double(muscle.fibres.size() - 1);
  muscle.volume = muscle.cross_section * muscle.mean_length;
  muscle.thickness = muscle.area > 0.0 ? muscle.volume / muscle.area : 0.0;
}

}  // namespace fascia::muscles
