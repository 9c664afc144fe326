#include "builder/muscles/orifice.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "builder/muscles/parts.h"
#include "geometry/error.h"

namespace fascia::muscles {

namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr int kArcRays = 17;  // rays from each lip or lid
constexpr int kFanRays = 9;   // rays around each corner

struct Start {
  Vec3 place;
  double angle = 0.0;  // of the outward direction, seen from the front
};

Vec3 needed(const std::map<std::string, Vec3>& landmarks, const std::string& name, const std::string& orifice) {
  const auto found = landmarks.find(name);
  if (found == landmarks.end())
    throw Error("muscles around " + orifice + ": landmark " + name + " is missing; place it on the skin");
  return found->second;
}

/// Rim of one lip or lid from corner `from` over `middle` to corner `to`, with its outward direction on
/// the left of the way when `outward_left`.
std::vector<Start> rim(const Vec3& from, const Vec3& middle, const Vec3& to, double side) {
  std::vector<Start> starts;
  for (int i = 0; i < kArcRays; ++i) {
    const double t = double(i) / (kArcRays - 1);
    // The parabola through the three.
    const Vec3 p = (1 - t) * (1 - 2 * t) * from + 4 * t * (1 - t) * middle + t * (2 * t - 1) * to;
    const Vec3 d = (4 * t - 3) * from + 4 * (1 - 2 * t) * middle + (4 * t - 1) * to;
    starts.push_back({p, std::atan2(-side * d[0], side * d[1])});
  }
  return starts;
}

double unwrapped(double angle, double near) { return angle - 2 * kPi * std::round((angle - near) / (2 * kPi)); }

/// Appends `starts` and then a fan around their last place until the first direction of `next`.
void append_with_corner(std::vector<Start>& all, const std::vector<Start>& starts, const Start& next) {
  for (const Start& start : starts) {
    all.push_back(start);
    if (all.size() > 1) all.back().angle = unwrapped(all.back().angle, all[all.size() - 2].angle);
  }
  const double begin = all.back().angle;
  double end = unwrapped(next.angle, begin + 0.5 * kPi);
  if (end < begin) end += 2 * kPi;
  for (int i = 1; i < kFanRays; ++i)
    all.push_back({starts.back().place, begin + (end - begin) * i / kFanRays});
}

std::vector<Start> rim_starts(const std::map<std::string, Vec3>& landmarks, const std::string& orifice) {
  Vec3 left, right, upper, lower;
  if (orifice == "mouth") {
    left = needed(landmarks, "cheilion_left", orifice);
    right = needed(landmarks, "cheilion_right", orifice);
    upper = lower = needed(landmarks, "stomion", orifice);
  } else {
    const bool is_left = orifice == "eye_left";
    const std::string side = is_left ? "_left" : "_right";
    const Vec3 outer = needed(landmarks, "exocanthion" + side, orifice);
    const Vec3 inner = needed(landmarks, "endocanthion" + side, orifice);
    left = is_left ? outer : inner;
    right = is_left ? inner : outer;
    upper = needed(landmarks, "palpebrale_superius" + side, orifice);
    lower = needed(landmarks, "palpebrale_inferius" + side, orifice);
  }
  if (left[0] - right[0] < 1e-6)
    throw Error("muscles around " + orifice + ": its corners lie in the wrong order; left is the subject's left");
  const std::vector<Start> up = rim(left, upper, right, 1.0), down = rim(right, lower, left, 1.0);
  std::vector<Start> all;
  append_with_corner(all, up, down.front());
  append_with_corner(all, down, up.front());
  return all;
}

/// Straight over the SMAS from the rim; straight through the air where the SMAS does not reach.
std::vector<Vec3> walk(const Carrier& smas, const Start& start, double step, int steps) {
  std::vector<Vec3> ray = {start.place};
  Vec3 direction(std::cos(start.angle), std::sin(start.angle), 0.0);
  bool landed = false;
  Vec3 at = start.place;
  for (int i = 0; i < steps; ++i) {
    Vec3 next = at + step * direction;
    const spatial::ClosestPoint closest = smas.query.closest(next);
    const Vec3 normal = smas.query.smooth_normal(closest.surface);
    const Vec3 gap = next - closest.position;
    if ((gap - normal * normal.dot(gap)).norm() < 0.3 * step) {
      if (!landed) {  // from the rim down to the SMAS without counting the depth as distance
        landed = true;
        for (size_t k = 0; k < ray.size(); ++k)
          ray[k] += normal * -normal.dot(gap) * (double(k + 1) / double(ray.size() + 1));
      }
      next = closest.position;
      const Vec3 flat = direction - normal * normal.dot(direction);
      if (flat.norm() > 1e-6) direction = flat.normalized();
    }
    at = next;
    ray.push_back(at);
  }
  return ray;
}

/// Points of a net put at their depth: on the SMAS, or between skin and lining where it has its opening.
FibrePoint at_depth(const Depths& depths, const Vec3& point, double fraction) {
  const Carrier& smas = depths.smas();
  const spatial::ClosestPoint closest = smas.query.closest(point);
  const Vec3 normal = smas.query.smooth_normal(closest.surface);
  const Vec3 gap = point - closest.position;
  if ((gap - normal * normal.dot(gap)).norm() < 5e-4) return depths.at(closest.surface, fraction);
  const spatial::ClosestPoint skin = depths.skin().closest(point);
  const Vec3 inward = -depths.skin().smooth_normal(skin.surface);
  return unbound(smas, skin.position + fraction * depths.thickness(closest.surface) * inward);
}

/// Ray coordinates of `count` points evenly spaced along the ring at `distance` between two angles.
std::vector<double> along_ring(const OrificeNet& net, double distance, double begin, double end, int count) {
  const int fine = 96;
  std::vector<double> rays, lengths = {0.0};
  for (int i = 0; i <= fine; ++i) {
    rays.push_back(net.ray_at(begin + (end - begin) * i / fine, distance));
    if (i == 0) continue;
    // Coordinates are cyclic: go on from the last one.
    const double around = double(net.rays.size());
    rays[i] += around * std::round((rays[i - 1] - rays[i]) / around);
    lengths.push_back(lengths.back() + (net.point(rays[i], distance) - net.point(rays[i - 1], distance)).norm());
  }
  std::vector<double> even;
  for (int i = 0; i < count; ++i) {
    const double wanted = lengths.back() * i / std::max(1, count - 1);
    const size_t k = std::clamp<size_t>(std::lower_bound(lengths.begin(), lengths.end(), wanted) - lengths.begin(), 1,
                                        lengths.size() - 1);
    const double step = lengths[k] - lengths[k - 1];
    const double share = step > 0.0 ? (wanted - lengths[k - 1]) / step : 0.0;
    even.push_back(rays[k - 1] + share * (rays[k] - rays[k - 1]));
  }
  return even;
}

double ring_length(const OrificeNet& net, double distance, double begin, double end) {
  double sum = 0.0;
  for (int i = 0; i < 24; ++i)
    sum += (net.point(net.ray_at(begin + (end - begin) * (i + 1) / 24, distance), distance) -
            net.point(net.ray_at(begin + (end - begin) * i / 24, distance), distance)).norm();
  return sum;
}

}  // namespace

Vec3 OrificeNet::point(double at, double distance) const {
  const int count = static_cast<int>(rays.size());
  const double wrapped = at - count * std::floor(at / count);
  const int i = std::min(static_cast<int>(wrapped), count - 1), j = (i + 1) % count;
  const double share = wrapped - i;
  const double along = std::clamp(distance / step, 0.0, double(rays[0].size() - 1));
  const size_t k = std::min(static_cast<size_t>(along), rays[0].size() - 2);
  const double rest = along - double(k);
  return (1 - share) * ((1 - rest) * rays[i][k] + rest * rays[i][k + 1]) +
         share * ((1 - rest) * rays[j][k] + rest * rays[j][k + 1]);
}

double OrificeNet::ray_at(double angle, double distance) const {
  const int count = static_cast<int>(rays.size());
  const auto offset = [&](int i) {  // of ray i's point from the angle asked for, in (−π, π]
    const Vec3 p = point(i, distance) - centre;
    return std::remainder(std::atan2(p[1], p[0]) - angle, 2 * kPi);
  };
  double before = offset(0);
  for (int i = 0; i < count; ++i) {
    const double after = offset((i + 1) % count);
    if (before <= 0.0 && after > 0.0 && after - before < kPi) return i + before / (before - after);
    before = after;
  }
  return 0.0;
}

OrificeNet orifice_net(const Carrier& smas, const std::map<std::string, Vec3>& landmarks, const std::string& orifice,
                       double reach) {
  const std::vector<Start> starts = rim_starts(landmarks, orifice);
  OrificeNet net;
  const int steps = std::clamp(static_cast<int>(std::ceil(reach / 0.0015)), 2, 60);
  net.step = reach / steps;
  for (const Start& start : starts) net.rays.push_back(walk(smas, start, net.step, steps));
  for (const Start& start : starts) net.centre += start.place / double(starts.size());
  if (orifice == "mouth")
    net.centre = 0.5 * (landmarks.at("cheilion_left") + landmarks.at("cheilion_right"));
  return net;
}

namespace {

/// Fibres that hang on the canthal ligament draw together towards it: what share of its distance from the orifice a fibre
/// keeps at `share` of its way from the medial end.
double kept_distance(double share) {
  constexpr double at_ligament = 0.35, way = 0.35;
  const double t = std::clamp(share / way, 0.0, 1.0);
  return at_ligament + (1.0 - at_ligament) * t * t * (3.0 - 2.0 * t);
}

/// Whether the band's first angle is its end nearer the median plane.
bool begins_medially(const anatomy::OrificeBand& band) {
  const double medial = band.orifice == "eye_left" ? kPi : 0.0;
  const auto off = [&](double angle) { return std::abs(std::remainder(angle - medial, 2 * kPi)); };
  return off(band.begin_angle) < off(band.end_angle);
}

}  // namespace

std::vector<Fibre> lay_rings(const Depths& depths, const OrificeNet& net, const anatomy::Muscle& muscle,
                             const Options& options) {
  const anatomy::OrificeBand& band = *muscle.band;
  const int count = fibre_count(band.outer - band.inner, muscle.bundles, options);
  std::vector<Fibre> fibres;
  for (int i = 0; i < count; ++i) {
    const double distance = band.inner + (band.outer - band.inner) * (i + 0.5) / count;
    const int points = point_count(ring_length(net, distance, band.begin_angle, band.end_angle), options);
    Fibre fibre;
    fibre.bundle = i * muscle.bundles / count;
    const std::vector<double> rays = along_ring(net, distance, band.begin_angle, band.end_angle, points);
    const bool medial_first = begins_medially(band);
    for (int k = 0; k < points; ++k) {
      const double share = double(k) / (points - 1);
      const double kept = band.medial_on_bone ? kept_distance(medial_first ? share : 1.0 - share) : 1.0;
      fibre.points.push_back(at_depth(depths, net.point(rays[k], kept * distance), sampled(muscle.depth_fraction, share)));
    }
    if (band.medial_on_bone && !medial_first) std::reverse(fibre.points.begin(), fibre.points.end());
    fibres.push_back(std::move(fibre));
  }
  return fibres;
}

std::vector<Fibre> lay_compressors(const Depths& depths, const OrificeNet& net, const anatomy::Muscle& muscle,
                                   const Options& options) {
  const anatomy::OrificeBand& band = *muscle.band;
  const int count =
      fibre_count(ring_length(net, band.outer, band.begin_angle, band.end_angle), muscle.bundles, options);
  std::vector<double> rays = along_ring(net, band.outer, band.begin_angle, band.end_angle, 2 * count + 1);
  std::vector<Fibre> fibres;
  for (int i = 0; i < count; ++i) {
    Fibre fibre;
    fibre.bundle = i * muscle.bundles / count;
    const int points = options.fewest_points;
    for (int k = 0; k < points; ++k) {
      const double share = double(k) / (points - 1);
      const double distance = band.outer + share * (band.inner - band.outer);
      fibre.points.push_back(
          at_depth(depths, net.point(rays[2 * i + 1], distance), sampled(muscle.depth_fraction, share)));
    }
    fibres.push_back(std::move(fibre));
  }
  return fibres;
}

}  // namespace fascia::muscles
