#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>

#include "builder/tissue/actuators.h"
#include "builder/tissue/lids.h"
#include "sim/realtime/solver.h"

namespace fascia::tissue {
namespace {

constexpr size_t stations = 33;
// Tolerances of the search for slits; they depend on meshes, not on anatomy.
constexpr double first = 0.05;       // of the fissure: nearer to a canthus both lids are one
constexpr double overlap = 0.03;     // radians by which a closed upper lid should overlap the lower one
constexpr double touching = -0.012;  // radians: larger is a slit, because edges are polygons between stations
constexpr double doubtful = 0.012;   // radians above `touching` within which a slit counts in part
constexpr double slope = 0.06;       // radians per station: largest change of the addition along a lid

/// The edges of the head's own mesh that lie along an eye's fissure, and the lid each is of.
class LidEdges {
 public:
  LidEdges(const FaceRegion& region, const Fissure& fissure, bool left) : fissure_(fissure) {
    const auto& distance =
        region.opening_distance[static_cast<size_t>(left ? Opening::eye_left : Opening::eye_right)];
    const auto is_near = [&](size_t v) { return distance[v] < Fissure::edge; };
    for (const fascia::Triangle& t : region.mesh.triangles)
      for (size_t e = 0; e < 3; ++e) {
        const auto a = static_cast<size_t>(t[e]), b = static_cast<size_t>(t[(e + 1) % 3]);
        if (!is_near(a) || !is_near(b)) continue;
        const Vec3 middle = 0.5 * (region.mesh.vertices[a] + region.mesh.vertices[b]);
        if (std::abs(fissure.elevation(middle)) > Fissure::widest) continue;
        edges_.push_back({a, b, fissure.is_upper(middle)});
      }
  }

  /// Radians between the lids' edges at each station where the region's vertices stand at `places`: less than
  /// 0 where the upper lid reaches over the lower one; `none` where there is no edge.
  std::array<double, stations> gaps(const std::vector<Vec3>& places) const {
    std::array<double, stations> upper, lower;
    upper.fill(none);
    lower.fill(none);
    constexpr double last = stations - 1;
    for (const Edge& one : edges_) {
      Vec3 a = places[one.a], b = places[one.b];
      if (fissure_.place(a) > fissure_.place(b)) std::swap(a, b);
      const double from = fissure_.place(a) * last, to = fissure_.place(b) * last;
      if (!(from < to)) continue;
      for (double k = std::max(0.0, std::ceil(from)); k <= std::min(last, to); k += 1.0) {
        const double height = fissure_.elevation(a + (k - from) / (to - from) * (b - a));
        double& best = (one.is_upper ? upper : lower)[static_cast<size_t>(k)];
        if (best == none || (one.is_upper ? height < best : height > best)) best = height;
      }
    }
    std::array<double, stations> gaps;
    for (size_t k = 0; k < stations; ++k)
      gaps[k] = upper[k] == none || lower[k] == none ? none : upper[k] - lower[k];
    return gaps;
  }

  static constexpr double none = 100.0;

 private:
  struct Edge {
    size_t a, b;  // of the region
    bool is_upper;
  };
  const Fissure& fissure_;
  std::vector<Edge> edges_;
};

/// Where the region's vertices stand when the nodes of `level` stand at `nodes`.
std::vector<Vec3> posed_region(const FaceRegion& region, const std::vector<Follow>& skin,
                               const rig::TissueLevel& level, const std::vector<rig::Vec3f>& nodes) {
  std::vector<Vec3> places = region.mesh.vertices;
  for (size_t v = 0; v < places.size(); ++v) {
    const Follow& follow = skin[static_cast<size_t>(region.skin_vertex[v])];
    for (size_t k = 0; k < Follow::influences; ++k)
      if (follow.weights[k] != 0.0F)
        places[v] += static_cast<double>(follow.weights[k]) *
                     (nodes[follow.nodes[k]] - level.rest[follow.nodes[k]]).cast<double>();
  }
  return places;
}

/// One eye: what its upper lid's columns are turned by at full closing, and what has been added.
struct Eye {
  Eye(const TissueInputs& inputs, const FaceRegion& region, bool left)
      : is_left(left),
        fissure(inputs, region, left),
        edges(region, fissure, left),
        channel(channel_index(inputs.channels, left ? "lid_upper_left" : "lid_upper_right")) {}

  /// Adds the width of the slit at each station; false when there is none. Additions without effect, as where
  /// a fold beside the lids was mistaken for a slit, are undone.
  bool widen(const std::vector<Vec3>& places) {
    constexpr double least_use = 0.08;  // radians closed, of one that was added
    constexpr double most_gain = 2.0;
    constexpr double least_given = 0.02;  // radians: of less it cannot be told what it did
    const auto gaps = edges.gaps(places);
    const auto ragged = ragged_stations(gaps);
    bool any = false;
    for (size_t k = 0; k < stations; ++k) {
      if (ragged[k]) continue;
      const double place = static_cast<double>(k) / (stations - 1);
      if (gaps[k] == LidEdges::none || place < first || place > 1.0 - first) continue;
      if (given[k] > least_given) {
        const double use = (before[k] - gaps[k]) / given[k];
        if (use < least_use) in_vain[k] = true;
        gain[k] = std::clamp(1.0 / std::max(use, 1e-3), 1.0, most_gain);
      }
      if (in_vain[k]) own[k] = 0.0;
      // Proportional near the bound, so that rounding of the pose cannot trigger a whole step.
      const double slit = std::clamp((gaps[k] - touching) / doubtful, 0.0, 1.0);
      given[k] = in_vain[k] ? 0.0 : slit * gain[k] * (gaps[k] + overlap);
      before[k] = gaps[k];
      if (given[k] == 0.0) continue;
      own[k] = std::min(added[k] + given[k], most_added(place));
      any = true;
    }
    spread();
    return any;
  }

  /// Stations that gape between ends where the gap jumps: an edge of the mesh that is torn there, not a slit.
  static std::array<bool, stations> ragged_stations(const std::array<double, stations>& gaps) {
    constexpr double jump = 0.2;  // radians from one station to the next
    const auto gapes = [&](size_t k) { return gaps[k] > touching && gaps[k] != LidEdges::none; };
    const auto falls = [&](size_t from, size_t to) { return gaps[from] - gaps[to] > jump; };
    std::array<bool, stations> ragged{};
    for (size_t begin = 0; begin < stations; ++begin) {
      if (!gapes(begin)) continue;
      size_t end = begin;
      while (end < stations && gapes(end))
        ++end;
      const bool tears = (begin > 0 && falls(begin, begin - 1)) || (end < stations && falls(end - 1, end));
      std::fill(ragged.begin() + static_cast<std::ptrdiff_t>(begin),
                ragged.begin() + static_cast<std::ptrdiff_t>(end), tears);
      begin = end;
    }
    return ragged;
  }

  /// More than this, in radians, would be another fault than the skin's resistance.
  double most_added(double place) const { return 0.3 + 0.5 * fissure.gap(place); }

  void spread() {
    for (size_t k = 0; k < stations; ++k) {
      added[k] = 0.0;
      for (size_t j = 0; j < stations; ++j)
        added[k] =
            std::max(added[k], own[j] - slope * std::abs(static_cast<double>(j) - static_cast<double>(k)));
    }
  }

  double added_at(double place) const {
    const double x = std::clamp(place, 0.0, 1.0) * (stations - 1);
    const auto k = std::min(static_cast<size_t>(x), stations - 2);
    const double t = x - static_cast<double>(k);
    return (1.0 - t) * added[k] + t * added[k + 1];
  }

  bool is_left;
  Fissure fissure;
  LidEdges edges;
  int channel;
  std::array<double, stations> added{};  ///< radians at full closing
  std::array<double, stations> own{};    ///< what each station asks for, before it is spread

 private:
  std::array<double, stations> before{}, given{}, gain = filled(1.2);
  std::array<bool, stations> in_vain{};

  static std::array<double, stations> filled(double value) {
    std::array<double, stations> all;
    all.fill(value);
    return all;
  }
};

/// Gives both eyes of a head that is the same on both sides what either asks for.
void share_with_image(Eye& left, Eye& right) {
  for (size_t k = 0; k < stations; ++k)
    left.own[k] = right.own[stations - 1 - k] = std::max(left.own[k], right.own[stations - 1 - k]);
  left.spread();
  right.spread();
}

/// A level's model and, if that is valid, its solver, which the next round's pose starts from.
struct Solved {
  Solved(const rig::TissueLevel& level, const TissueInputs& inputs, const sim::FaceModelOptions& options)
      : model(sim::lattice_of(level), sim::jaw_of(inputs.jaw), options) {
    if (!model.valid()) return;
    fast.emplace(model);
    if (fast->valid()) face.emplace(*fast, inputs.channels.size());
  }

  sim::FaceModel model;
  std::optional<sim::realtime::Model> fast;
  std::optional<sim::realtime::Solver> face;
};

}  // namespace

void settle_lids(const TissueInputs& inputs, const FaceRegion& region, const Columns& c,
                 const std::vector<Follow>& skin, bool is_mirrored, const sim::FaceModelOptions& solver,
                 rig::TissueLevel& level) {
  constexpr int rounds = 5;
  if (inputs.blink.empty()) return;
  std::vector<Eye> eyes;
  eyes.reserve(2);
  for (const bool left : {true, false}) {
    eyes.emplace_back(inputs, region, left);
    if (eyes.back().fissure.is_closed() || eyes.back().channel < 0) eyes.pop_back();
  }
  const auto n = static_cast<size_t>(c.count());
  const std::vector<float> angles = level.carrier_angle;
  // A slit is told to a hundredth of a millimetre; iterations beyond that would only add to the time of a
  // build.
  sim::PoseOptions pose;
  pose.solver.tolerance = 1e-5;
  pose.newton.iterations = 0;
  std::unique_ptr<Solved> last;
  for (int round = 0; round < rounds && !eyes.empty(); ++round) {
    auto solved = std::make_unique<Solved>(level, inputs, solver);
    if (!solved->face) return;
    if (last) solved->face->continue_from(*last->face);
    pose.from_last_pose = last != nullptr;
    std::vector<rig::Vec3f> nodes(level.rest.size());
    sim::Controls controls;
    controls.activations = inputs.blink;
    solved->face->static_pose(controls, pose, nodes);
    last = std::move(solved);
    if (!std::all_of(nodes.begin(), nodes.end(), [](const rig::Vec3f& p) { return p.allFinite(); })) return;
    const std::vector<Vec3> places = posed_region(region, skin, level, nodes);
    bool any = false;
    for (Eye& eye : eyes)
      any = eye.widen(places) || any;
    if (!any) return;
    if (is_mirrored && eyes.size() == 2) share_with_image(eyes[0], eyes[1]);
    for (size_t k = 0; k < level.carrier_angle.size(); ++k)
      for (const Eye& eye : eyes) {
        if (static_cast<int>(level.carrier_channel[k]) != eye.channel) continue;
        const size_t v = level.carrier_node[k] % n;
        level.carrier_angle[k] =
            angles[k] + static_cast<float>(eye.added_at(eye.fissure.place(c.mesh.vertices[v])) *
                                           closing_share(inputs, c, eye.fissure, v));
      }
  }
}

}  // namespace fascia::tissue
