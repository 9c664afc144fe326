#include "builder/tissue/fissure.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "builder/tissue/distance.h"
#include "builder/tissue/margin.h"

namespace fascia::tissue {
namespace {

constexpr size_t steps = 33;

/// What a triangle covers of the line on which `place` is `at`: elevations from..to; nothing where it lies
/// beside it.
std::optional<std::array<double, 2>> covered(const std::array<double, 3>& place,
                                             const std::array<double, 3>& elevation, double at) {
  std::optional<std::array<double, 2>> range;
  for (size_t e = 0; e < 3; ++e) {
    const size_t f = (e + 1) % 3;
    if ((place[e] <= at) == (place[f] <= at)) continue;
    const double value =
        elevation[e] + (at - place[e]) / (place[f] - place[e]) * (elevation[f] - elevation[e]);
    if (!range) range = {value, value};
    range = {std::min((*range)[0], value), std::max((*range)[1], value)};
  }
  return range;
}

/// The middle of the widest stretch that no range covers, between some that lie below and above it; nothing
/// where there is none wider than `least`.
std::optional<double> middle_of_opening(std::vector<std::array<double, 2>> ranges, double least) {
  std::sort(ranges.begin(), ranges.end());
  std::optional<double> middle;
  for (size_t i = 1; i < ranges.size(); ++i) {
    ranges[i][1] = std::max(ranges[i][1], ranges[i - 1][1]);
    const double below = ranges[i - 1][1], above = ranges[i][0];
    if (!(above - below > least)) continue;
    least = above - below;
    middle = 0.5 * (above + below);
  }
  return middle;
}

/// What `values`, in even steps from canthus to canthus, come to at `place` between them.
double at_place(const std::vector<double>& values, double place) {
  const double x = std::clamp(place, 0.0, 1.0) * static_cast<double>(steps - 1);
  const auto k = std::min(static_cast<size_t>(x), steps - 2);
  const double t = x - static_cast<double>(k);
  return (1.0 - t) * values[k] + t * values[k + 1];
}

/// Fills what is not known between what is, evenly.
void fill_between(std::vector<double>& values, const std::vector<bool>& is_known) {
  for (size_t k = 1, known = 0; k < values.size(); ++k) {
    if (!is_known[k]) continue;
    for (size_t i = known + 1; i < k; ++i)
      values[i] = values[known] + (values[k] - values[known]) * static_cast<double>(i - known) /
                                      static_cast<double>(k - known);
    known = k;
  }
}

}  // namespace

Fissure::Fissure(const TissueInputs& inputs, const FaceRegion& region, bool left) {
  const rig::Eye eye = eye_of(inputs, left);
  const std::string side = left ? "_left" : "_right";
  const Vec3 inner = landmark(inputs, "endocanthion" + side), outer = landmark(inputs, "exocanthion" + side);
  const Vec3 &a = left ? inner : outer, &b = left ? outer : inner;  // a to the subject's right
  centre = eye.centre.cast<double>();
  radius = static_cast<double>(eye.radius);
  lateral = (b - a).normalized();
  front = 0.5 * (a + b) - centre;
  front = (front - front.dot(lateral) * lateral).normalized();
  up = front.cross(lateral);
  right_ = (a - centre).dot(lateral);
  left_ = (b - centre).dot(lateral);
  right_elevation_ = elevation(a);
  left_elevation_ = elevation(b);
  reach_canthi(region, left);
  find_middle(region, left);
  find_gaps(region, left);
  find_closed_lids(region, left);
}

void Fissure::reach_canthi(const FaceRegion& region, bool left) {
  const auto& distance =
      region.opening_distance[static_cast<size_t>(left ? Opening::eye_left : Opening::eye_right)];
  constexpr double least = 0.04, most = 0.2;  // of the fissure's width: less is as good as the landmark
  const double width = left_ - right_;
  double right = 0.0, far_left = 1.0, right_elevation = right_elevation_, left_elevation = left_elevation_;
  for (size_t v = 0; v < distance.size(); ++v) {
    if (distance[v] > 0.0 || !region.outer[v]) continue;
    const Vec3& p = region.mesh.vertices[v];
    const double at = place(p);
    if (at < -most || at > 1.0 + most || std::abs(elevation(p)) > widest) continue;
    if (at < std::min(right, -least)) {
      right = at;
      right_elevation = elevation(p);
    } else if (at > std::max(far_left, 1.0 + least)) {
      far_left = at;
      left_elevation = elevation(p);
    }
  }
  left_ = right_ + far_left * width;
  right_ += right * width;
  left_elevation_ = left_elevation;
  right_elevation_ = right_elevation;
}

double Fissure::elevation(const Vec3& p) const {
  const Vec3 arm = p - centre;
  return std::atan2(arm.dot(up), arm.dot(front));
}

double Fissure::place(const Vec3& p) const {
  return ((p - centre).dot(lateral) - right_) / (left_ - right_);
}

double Fissure::middle(double place) const {
  return at_place(middle_, place);
}

void Fissure::find_middle(const FaceRegion& region, bool left) {
  constexpr double least = 0.08;  // radians: narrower is no opening but a seam between triangles
  constexpr double last = steps - 1;
  const auto& distance =
      region.opening_distance[static_cast<size_t>(left ? Opening::eye_left : Opening::eye_right)];
  std::vector<std::vector<std::array<double, 2>>> ranges(steps);
  for (const fascia::Triangle& t : region.mesh.triangles) {
    std::array<double, 3> at{}, high{};
    bool is_lid = true;
    for (size_t k = 0; k < 3; ++k) {
      const auto v = static_cast<size_t>(t[k]);
      at[k] = place(region.mesh.vertices[v]) * last;
      high[k] = elevation(region.mesh.vertices[v]);
      is_lid = is_lid && distance[v] < edge && std::abs(high[k]) < widest;
    }
    if (!is_lid) continue;
    const auto [from, to] = std::minmax({at[0], at[1], at[2]});
    for (double k = std::max(0.0, std::ceil(from)); k <= std::min(last, to); k += 1.0)
      if (const auto range = covered(at, high, k)) ranges[static_cast<size_t>(k)].push_back(*range);
  }
  middle_.assign(steps, 0.0);
  std::vector<bool> is_known(steps, false);
  for (size_t k = 1; k + 1 < steps; ++k)
    if (const auto middle = middle_of_opening(ranges[k], least)) {
      middle_[k] = *middle;
      is_known[k] = true;
    }
  middle_.front() = right_elevation_;
  middle_.back() = left_elevation_;
  is_known.front() = is_known.back() = true;
  fill_between(middle_, is_known);
}

void Fissure::find_gaps(const FaceRegion& region, bool left) {
  // A lid reaches over the globe to the lowest place of the upper one, the highest of the lower: not where
  // the lining begins.
  const auto& distance =
      region.opening_distance[static_cast<size_t>(left ? Opening::eye_left : Opening::eye_right)];
  std::vector<double> upper(steps, 4.0), lower(steps, -4.0);
  std::vector<SurfacePoint> upper_places(steps), lower_places(steps);
  constexpr double last = steps - 1;
  const auto look_along = [&](size_t t, size_t first, size_t second) {
    const fascia::Triangle& corners = region.mesh.triangles[t];
    const Vec3 &a = region.mesh.vertices[static_cast<size_t>(corners[first])],
               &b = region.mesh.vertices[static_cast<size_t>(corners[second])];
    const double from = place(a) * last, to = place(b) * last;
    if (!(from < to)) return;
    for (double k = std::max(0.0, std::ceil(from)); k <= std::min(last, to); k += 1.0) {
      const double share = (k - from) / (to - from), value = elevation(a + share * (b - a));
      if (std::abs(value) > widest) continue;  // so far round the globe is its socket, not a lid
      const bool above = is_upper(a + share * (b - a));
      const auto step = static_cast<size_t>(k);
      double& best = above ? upper[step] : lower[step];
      if (above ? value >= best : value <= best) continue;
      best = value;
      SurfacePoint& place = above ? upper_places[step] : lower_places[step];
      place.triangle = static_cast<int>(t);
      place.barycentric.setZero();
      place.barycentric[static_cast<int>(first)] = 1.0 - share;
      place.barycentric[static_cast<int>(second)] = share;
    }
  };
  for (size_t t = 0; t < region.mesh.triangles.size(); ++t)
    for (size_t e = 0; e < 3; ++e) {
      const auto a = static_cast<size_t>(region.mesh.triangles[t][e]),
                 b = static_cast<size_t>(region.mesh.triangles[t][(e + 1) % 3]);
      if (a >= distance.size() || b >= distance.size() || !(distance[a] < edge) || !(distance[b] < edge))
        continue;
      look_along(t, e, (e + 1) % 3);
      look_along(t, (e + 1) % 3, e);
    }
  for (const auto* places : {&upper_places, &lower_places})
    for (const SurfacePoint& place : *places)
      if (place.triangle >= 0) edges_.push_back(place);
  gaps_.assign(steps, 0.0);
  std::vector<bool> is_known(steps, false);
  for (size_t k = 1; k + 1 < steps; ++k)
    if (upper[k] < 4.0 && lower[k] > -4.0) {
      gaps_[k] = std::clamp(upper[k] - lower[k], 0.0, widest);
      is_known[k] = true;
    }
  is_known.front() = is_known.back() = true;
  fill_between(gaps_, is_known);
  for (int pass = 0; pass < 2; ++pass) {
    std::vector<double> next = gaps_;
    for (size_t k = 1; k + 1 < steps; ++k)
      next[k] = 0.25 * (gaps_[k - 1] + 2.0 * gaps_[k] + gaps_[k + 1]);
    gaps_ = std::move(next);
  }
}

void Fissure::find_closed_lids(const FaceRegion& region, bool left) {
  const Opening opening = left ? Opening::eye_left : Opening::eye_right;
  constexpr double closed = 0.05;  // radians: half a millimetre before a globe of 12 mm
  std::vector<double> low(steps, 4.0), high(steps, -4.0);
  for (const MarginPlace& margin : margin_places(region, opening)) {
    const double x = place(margin.position);
    if (x < 0.08 || x > 0.92) continue;
    const auto k = static_cast<size_t>(std::lround(x * static_cast<double>(steps - 1)));
    low[k] = std::min(low[k], elevation(margin.position));
    high[k] = std::max(high[k], elevation(margin.position));
  }
  double farthest = 0.0, sum = 0.0;
  int known = 0;
  for (size_t k = 0; k < steps; ++k)
    if (high[k] >= low[k]) {
      farthest = std::max(farthest, high[k] - low[k]);
      sum += 0.5 * (low[k] + high[k]);
      ++known;
    }
  // A slope within a step counts as little as the step is wide.
  if (2 * known < static_cast<int>(steps) || farthest > 3.0 * closed) return;
  const double level = sum / known;
  const auto& distance = region.opening_distance[static_cast<size_t>(opening)];
  std::array<std::vector<DistanceSeed>, 2> seeds;
  for (size_t v = 0; v < region.mesh.vertices.size(); ++v) {
    const Vec3& p = region.mesh.vertices[v];
    if (!region.outer[v] || !(distance[v] > 0.003) || distance[v] > 0.016) continue;
    const double x = place(p), off = elevation(p) - level;
    if (x > 0.15 && x < 0.85 && std::abs(off) > 0.25) seeds[off > 0.0].push_back({static_cast<int>(v)});
  }
  if (seeds[0].empty() || seeds[1].empty()) return;
  const EdgeDistances below = surface_distances(region.mesh, seeds[0], 0.06),
                      above = surface_distances(region.mesh, seeds[1], 0.06);
  upper_share.assign(region.mesh.vertices.size(), 0.5);
  for (size_t v = 0; v < upper_share.size(); ++v)
    if (std::isfinite(above.distance[v] + below.distance[v]))
      upper_share[v] = below.distance[v] / std::max(above.distance[v] + below.distance[v], 1e-9);
    else if (std::isfinite(above.distance[v]) || std::isfinite(below.distance[v]))
      upper_share[v] = std::isfinite(above.distance[v]) ? 1.0 : 0.0;
  gaps_.assign(steps, 0.0);
  edges_.clear();
}

bool Fissure::is_upper(const FaceRegion& region, const SurfacePoint& place, const Vec3& p) const {
  if (!is_closed()) return is_upper(p);
  const fascia::Triangle& corners = region.mesh.triangles[static_cast<size_t>(place.triangle)];
  double share = 0.0;
  for (size_t k = 0; k < 3; ++k)
    share += place.barycentric[static_cast<int>(k)] * upper_share[static_cast<size_t>(corners[k])];
  return share > 0.5;
}

double Fissure::gap(double place) const {
  return at_place(gaps_, place);
}

}  // namespace fascia::tissue
