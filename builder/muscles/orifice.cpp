#include "builder/muscles/orifice.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "builder/muscles/order.h"
#include "builder/muscles/parts.h"
#include "geometry/error.h"
#include "geometry/smoothstep.h"

namespace fascia::muscles {

namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr int kArcRays = 17;  // rays from each lip or lid
constexpr int kFanRays = 9;   // rays around each corner

struct Start {
  Vec3 place;
  double angle = 0.0;  // of the outward direction, seen from the front
};

Vec3 needed(const Landmarks& landmarks, const std::string& name, const std::string& orifice) {
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

double unwrapped(double angle, double near) {
  return angle - 2 * kPi * std::round((angle - near) / (2 * kPi));
}

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

std::vector<Start> rim_starts(const Landmarks& landmarks, const std::string& orifice) {
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
    throw Error("muscles around " + orifice +
                ": its corners lie in the wrong order; left is the subject's left");
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

/// Points of a net put at their depth: on the SMAS, or, in its opening, where it would be if it went straight
/// on.
FibrePoint at_depth(const Depths& depths, const Vec3& point, double fraction) {
  const Carrier& smas = depths.smas();
  const spatial::ClosestPoint closest = smas.query.closest(point);
  const Vec3 normal = smas.query.smooth_normal(closest.surface);
  const Vec3 gap = point - closest.position, beside = gap - normal * normal.dot(gap);
  const FibrePoint bound = depths.at(closest.surface, fraction);
  return beside.norm() < 5e-4 ? bound : unbound(smas, bound.position + beside);
}

/// Ray coordinates of `count` points evenly spaced along the ring at `distance` between two angles.
std::vector<double> along_ring(const OrificeNet& net, double distance, double begin, double end, int count) {
  const int fine = 96;
  const OrificeNet::Ring ring = net.ring(distance);
  std::vector<double> rays, lengths = {0.0};
  for (int i = 0; i <= fine; ++i) {
    rays.push_back(net.ray_at(begin + (end - begin) * i / fine, ring));
    if (i == 0) continue;
    // Coordinates are cyclic: go on from the last one.
    const double around = double(net.rays.size());
    rays[i] += around * std::round((rays[i - 1] - rays[i]) / around);
    lengths.push_back(lengths.back() +
                      (net.point(rays[i], distance) - net.point(rays[i - 1], distance)).norm());
  }
  std::vector<double> even;
  for (int i = 0; i < count; ++i) {
    const double wanted = lengths.back() * i / std::max(1, count - 1);
    const size_t k = std::clamp<size_t>(
        std::lower_bound(lengths.begin(), lengths.end(), wanted) - lengths.begin(), 1, lengths.size() - 1);
    const double step = lengths[k] - lengths[k - 1];
    const double share = step > 0.0 ? (wanted - lengths[k - 1]) / step : 0.0;
    even.push_back(rays[k - 1] + share * (rays[k] - rays[k - 1]));
  }
  return even;
}

double ring_length(const OrificeNet& net, double distance, double begin, double end) {
  const OrificeNet::Ring ring = net.ring(distance);
  const auto at = [&](int i) {
    return net.point(net.ray_at(begin + (end - begin) * i / 24, ring), distance);
  };
  double sum = 0.0;
  Vec3 last = at(0);
  for (int i = 1; i <= 24; ++i) {
    const Vec3 next = at(i);
    sum += (next - last).norm();
    last = next;
  }
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

OrificeNet::Ring OrificeNet::ring(double distance) const {
  Ring ring;
  for (size_t i = 0; i < rays.size(); ++i) {
    ring.points.push_back(point(double(i), distance));
    const Vec3 p = ring.points.back() - centre;
    ring.angles.push_back(std::atan2(p[1], p[0]));
  }
  return ring;
}

double OrificeNet::ray_at(double angle, const Ring& ring) const {
  const size_t count = rays.size();
  const auto offset = [&](size_t i) {  // of ray i's point from the angle asked for, in (−π, π]
    double off = ring.angles[i] - angle;
    while (off > kPi)
      off -= 2 * kPi;
    while (off <= -kPi)
      off += 2 * kPi;
    return off;
  };
  // Close to the rim the rays of a curved lip may be seen at the angle twice: the ring's place is the
  // outermost.
  double before = offset(0), best = 0.0, farthest = -1.0;
  for (size_t i = 0; i < count; ++i) {
    const size_t next = (i + 1) % count;
    const double after = offset(next);
    if (before <= 0.0 && after > 0.0 && after - before < kPi) {
      const double share = before / (before - after);
      const Vec3 off = (1.0 - share) * ring.points[i] + share * ring.points[next] - centre;
      const double out = off.head<2>().norm();
      if (out > farthest) {
        farthest = out;
        best = double(i) + share;
      }
    }
    before = after;
  }
  return best;
}

OrificeNet orifice_net(const Carrier& smas, const Landmarks& landmarks, const std::string& orifice,
                       double reach) {
  const std::vector<Start> starts = rim_starts(landmarks, orifice);
  OrificeNet net;
  const int steps = std::clamp(static_cast<int>(std::ceil(reach / 0.0015)), 2, 60);
  net.step = reach / steps;
  for (const Start& start : starts)
    net.rays.push_back(walk(smas, start, net.step, steps));
  for (const Start& start : starts)
    net.centre += start.place / double(starts.size());
  // Between the corners, but as high as the lips meet in the middle: so rings close to the lips pass it on
  // their own side.
  if (orifice == "mouth") {
    net.centre = 0.5 * (landmarks.at("cheilion_left") + landmarks.at("cheilion_right"));
    net.centre[1] = landmarks.at("stomion")[1];
  }
  return net;
}

namespace {

/// Fibres that hang on the canthal ligament draw together towards it: what share of its distance from the
/// orifice a fibre keeps at `share` of its way from the medial end.
double kept_distance(double share) {
  constexpr double at_ligament = 0.35, way = 0.35;
  return at_ligament + (1.0 - at_ligament) * smoothstep(share / way);
}

/// Where the node of a modiolus lies on the net.
struct NodeOnNet {
  double ray = 0.0, distance = 0.0, radius = 0.0;
};

NodeOnNet node_on_net(const OrificeNet& net, const Modiolus& modiolus) {
  NodeOnNet node;
  double nearest = 1e300;
  for (size_t ray = 0; ray < net.rays.size(); ++ray)
    for (size_t k = 0; k < net.rays[ray].size(); ++k) {
      const double off = (net.rays[ray][k] - modiolus.centre).squaredNorm();
      if (off < nearest) {
        nearest = off;
        node = {double(ray), double(k) * net.step, modiolus.radius};
      }
    }
  return node;
}

/// The node that a band of the mouth ends in at `angle`; none away from the corners.
std::optional<NodeOnNet> node_at(const OrificeNet& net, const std::vector<Modiolus>& modioli, double angle) {
  if (std::abs(std::cos(angle)) < 0.9) return std::nullopt;
  for (const Modiolus& modiolus : modioli)
    if ((modiolus.side == anatomy::Side::left) == (std::cos(angle) > 0.0)) return node_on_net(net, modiolus);
  return std::nullopt;
}

/// Moves a ring's place on the net (`ray`, `reach` from the rim) towards the node at its end, `share` of the
/// ring away. Rings keep their order: at the corner of the mouth they lie side by side across the node.
void draw_to_node(const OrificeNet& net, const NodeOnNet& node, double share, double& ray, double& reach) {
  constexpr double way = 0.35, widest_band = 0.022;  // of the ring; metres
  const double drawn = smoothstep(1.0 - share / way);
  const double at_node =
      node.distance + std::min(1.0, node.radius / widest_band) * (reach - 0.5 * widest_band);
  ray += drawn * std::remainder(node.ray - ray, double(net.rays.size()));
  reach += drawn * (std::max(0.0005, at_node) - reach);
}

/// Whether the band's first angle is its end nearer the median plane.
bool begins_medially(const anatomy::OrificeBand& band) {
  const double medial = band.orifice == "eye_left" ? kPi : 0.0;
  const auto off = [&](double angle) { return std::abs(std::remainder(angle - medial, 2 * kPi)); };
  return off(band.begin_angle) < off(band.end_angle);
}

}  // namespace

std::vector<Fibre> lay_rings(const Depths& depths, const OrificeNet& net, const anatomy::Muscle& muscle,
                             const std::vector<Modiolus>& modioli, const Options& options) {
  const anatomy::OrificeBand& band = *muscle.band;
  const int count = fibre_count(band.outer - band.inner, muscle, options);
  const bool medial_first = begins_medially(band);
  std::optional<NodeOnNet> first, last;
  if (band.orifice == "mouth") {
    first = node_at(net, modioli, band.begin_angle);
    last = node_at(net, modioli, band.end_angle);
  }
  std::vector<Fibre> fibres;
  for (int i = 0; i < count; ++i) {
    const double distance = band.inner + (band.outer - band.inner) * (i + 0.5) / count;
    const int points = point_count(ring_length(net, distance, band.begin_angle, band.end_angle), options);
    Fibre fibre;
    fibre.bundle = i * muscle.bundles / count;
    const std::vector<double> rays = along_ring(net, distance, band.begin_angle, band.end_angle, points);
    for (int k = 0; k < points; ++k) {
      const double share = double(k) / (points - 1);
      double ray = rays[k], reach = distance;
      if (band.medial_on_bone) reach *= kept_distance(medial_first ? share : 1.0 - share);
      if (first) draw_to_node(net, *first, share, ray, reach);
      if (last) draw_to_node(net, *last, 1.0 - share, ray, reach);
      fibre.points.push_back(at_depth(depths, net.point(ray, reach), sampled(muscle.depth_fraction, share)));
    }
    if (band.medial_on_bone && !medial_first) std::reverse(fibre.points.begin(), fibre.points.end());
    fibres.push_back(std::move(fibre));
  }
  put_in_order(
      fibres, depths.smas().query,
      [&](const Vec3& position, double share) {
        return depths.near(position, sampled(muscle.depth_fraction, share));
      },
      false);
  return fibres;
}

std::vector<Fibre> lay_compressors(const Depths& depths, const OrificeNet& net, const anatomy::Muscle& muscle,
                                   const Options& options) {
  const anatomy::OrificeBand& band = *muscle.band;
  const int count =
      fibre_count(ring_length(net, band.outer, band.begin_angle, band.end_angle), muscle, options);
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
  put_in_order(
      fibres, depths.smas().query,
      [&](const Vec3& position, double share) {
        return depths.near(position, sampled(muscle.depth_fraction, share));
      },
      false);
  return fibres;
}

}  // namespace fascia::muscles
