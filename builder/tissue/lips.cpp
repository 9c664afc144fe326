#include <algorithm>
#include <array>
#include <cmath>

#include "builder/tissue/actuators.h"
#include "builder/tissue/margin.h"
#include "geometry/smoothstep.h"

namespace fascia::tissue {
void add_lip_rolls(const TissueInputs& inputs, const FaceRegion& region, const Beneath& beneath,
                   const Columns& c, rig::TissueLevel& level) {
  constexpr double side_blend = 0.005;  // metres from the midline over which left passes into right
  const anatomy::mechanics::Lips& m = inputs.mechanics.lips;
  const Vec3 left = landmark(inputs, "cheilion_left"), right = landmark(inputs, "cheilion_right");
  const Vec3 centre = 0.5 * (left + right);
  const double half = 0.5 * (left - right).norm();
  const auto& distance = c.opening_distance[static_cast<size_t>(Opening::mouth)];
  const auto n = static_cast<size_t>(c.count());
  const auto place_of = [&](const Vec3& p) { return 0.5 + 0.5 * (p.x() - centre.x()) / half; };
  // Height and depth of each lip's edge.
  std::array<Margin, 2> edges;
  for (const MarginPlace& p : margin_places(region, Opening::mouth))
    edges[beneath.lower_lip[static_cast<size_t>(p.vertex)] < 0.5].add(place_of(p.position),
                                                                      p.position.tail<2>());
  for (const bool upper : {true, false}) {
    const Margin& edge = edges[upper];
    if (edge.empty()) continue;
    for (size_t v = 0; v < n; ++v) {
      const Vec3& p = c.mesh.vertices[v];
      if (c.rim[v] || distance[v] > m.roll_fade.end || (c.lower_lip[v] < 0.5) != upper) continue;
      // The lip's body lies above (below) and behind its edge: the vermilion turns about that, the white lip
      // stays.
      const Eigen::Vector2d at = edge.at(place_of(p));
      const Vec3 origin(p.x(), at.x() + (upper ? m.roll_depth : -m.roll_depth), at.y() - m.roll_depth);
      const double fade =
          m.roll_fade.fall(distance[v]) * m.roll_lateral_fade.fall(std::abs(p.x() - centre.x()) / half);
      for (const bool is_left : {true, false}) {
        const double side =
            smoothstep(-side_blend, side_blend, is_left ? p.x() - centre.x() : centre.x() - p.x());
        const int channel =
            channel_index(inputs.channels, std::string("lip_roll_") + (upper ? "upper" : "lower") +
                                               (is_left ? "_left" : "_right"));
        if (channel < 0 || side * fade < 0.02) continue;
        for (const size_t node : {v, n + v}) {
          level.carrier_channel.push_back(static_cast<uint32_t>(channel));
          level.carrier_node.push_back(static_cast<uint32_t>(node));
          level.carrier_origin.push_back(origin.cast<float>());
          level.carrier_axis.push_back(rig::Vec3f::UnitX());
          level.carrier_angle.push_back(static_cast<float>(upper ? m.roll_in : -m.roll_in));
          level.carrier_reverse.push_back(static_cast<float>(upper ? -m.roll_out : m.roll_out));
          level.carrier_stiffness.push_back(0.0F);  // lips are moved, never held
          level.carrier_drive.push_back(static_cast<float>(m.roll_drive * c.area[v] * fade * side));
        }
      }
    }
  }
}

namespace {

// The seal is contact that draws from afar: a penalty's stiffness (newton per metre of gap, of each side's
// lips together), not tissue's, and how much of each lip it takes hold of.
constexpr double seal_hold = 1200.0, seal_reach = 0.004;

/// A column near the lips' edge.
struct LipColumn {
  size_t column;
  double place,
      share;  ///< across the mouth, 0 its right corner .. 1 its left; of the hold, by area and nearness
};

/// Adds a strand between two nodes that pulls them together.
void add_strand(const Columns& c, size_t from, size_t to, double hold, int channel, uint32_t muscle,
                rig::TissueLevel& level) {
  constexpr double shortest =
      0.3;  // of the length at rest, where the pull ends: the lips' own contact is before
  constexpr double least_length = 0.0005;  // metres: lips that touch at rest
  const std::vector<rig::Vec3f>& rest = level.rest;
  const double length = std::max(least_length, static_cast<double>((rest[to] - rest[from]).norm()));
  for (const size_t node : {from, to}) {
    const auto n = static_cast<uint32_t>(node);
    level.fibre_nodes.push_back({n, n, n});
    level.fibre_weights.push_back(rig::Vec3f(1.0F, 0.0F, 0.0F));
    level.fibre_rest.push_back(rest[node]);
    level.fibre_anchor.push_back(node < static_cast<size_t>(c.count()) ? rig::FibreEnd::skin
                                                                       : rig::FibreEnd::smas);
    level.fibre_taper.push_back(1.0F);
  }
  level.fibre_offsets.push_back(static_cast<uint32_t>(level.fibre_nodes.size()));
  level.fibre_muscle.push_back(muscle);
  level.fibre_channel.push_back(static_cast<uint32_t>(channel));
  level.fibre_strength.push_back(static_cast<float>(hold * length * (1.0 - shortest)));
  level.fibre_shortest.push_back(static_cast<float>(shortest));
}

}  // namespace

void add_lip_seal(const TissueInputs& inputs, const Columns& c, rig::TissueLevel& level) {
  const Vec3 left = landmark(inputs, "cheilion_left"), right = landmark(inputs, "cheilion_right");
  const auto& distance = c.opening_distance[static_cast<size_t>(Opening::mouth)];
  constexpr double corner_share = 0.06;  // of the way from lip to lip: at the corner both lips are one
  for (const bool is_left : {true, false}) {
    const std::string side = is_left ? "_left" : "_right";
    const int channel = channel_index(inputs.channels, "lip_seal" + side);
    const auto muscle = std::find_if(
        inputs.muscles.begin(), inputs.muscles.end(),
        [&](const rig::Muscle& one) { return one.name == "orbicularis_oris_marginal_upper" + side; });
    if (channel < 0 || muscle == inputs.muscles.end()) continue;
    std::array<std::vector<LipColumn>, 2> lips;  // upper, lower
    double sum = 0.0;
    for (size_t v = 0; v < static_cast<size_t>(c.count()); ++v) {
      const double place = (c.mesh.vertices[v].x() - right.x()) / (left.x() - right.x());
      const bool is_lower = c.lower_lip[v] > 0.5;
      if (c.rim[v] || !(distance[v] < seal_reach) || std::abs(c.lower_lip[v] - 0.5) < corner_share ||
          place <= 0.02 || place >= 0.98 || (place > 0.5) != is_left)
        continue;
      const double nearness = 1.0 - distance[v] / seal_reach;
      lips[is_lower].push_back({v, place, c.area[v] * nearness});
      sum += is_lower ? 0.0 : lips[0].back().share;
    }
    if (lips[0].empty() || lips[1].empty() || !(sum > 0.0)) continue;
    const auto index = static_cast<uint32_t>(muscle - inputs.muscles.begin());
    // Each place of the upper lip meets the one of the lower across from it, as far from the edge as itself.
    for (const LipColumn& upper : lips[0]) {
      const auto apart = [&](const LipColumn& lower) {
        return std::abs(lower.place - upper.place) * (left - right).norm() +
               std::abs(distance[lower.column] - distance[upper.column]) +
               (c.outer[lower.column] == c.outer[upper.column] ? 0.0 : seal_reach);
      };
      const auto lower = std::min_element(lips[1].begin(), lips[1].end(),
                                          [&](const auto& a, const auto& b) { return apart(a) < apart(b); });
      add_strand(c, upper.column, lower->column, seal_hold * upper.share / sum, channel, index, level);
    }
  }
}

}  // namespace fascia::tissue
