#include <algorithm>
#include <array>
#include <cmath>
#include <string>

#include "builder/tissue/actuators.h"
#include "builder/tissue/margin.h"
#include "geometry/smoothstep.h"

namespace fascia::tissue {
namespace {

/// The lips' edges and what of the mouth lies where.
struct LipEdges {
  LipEdges(const TissueInputs& inputs, const FaceRegion& region, const Beneath& beneath)
      : centre(0.5 * (landmark(inputs, "cheilion_left") + landmark(inputs, "cheilion_right"))),
        half(0.5 * (landmark(inputs, "cheilion_left") - landmark(inputs, "cheilion_right")).norm()),
        blend(inputs.mechanics.lips.side_blend) {
    for (const MarginPlace& p : margin_places(region, Opening::mouth))
      edges[beneath.lower_lip[static_cast<size_t>(p.vertex)] < 0.5].add(place_of(p.position),
                                                                        p.position.tail<2>());
  }
  double place_of(const Vec3& p) const { return 0.5 + 0.5 * (p.x() - centre.x()) / half; }
  /// Way from the midline, in half widths of the mouth.
  double lateral(const Vec3& p) const { return std::abs(p.x() - centre.x()) / half; }
  /// How much of a place belongs to a side.
  double side(const Vec3& p, bool left) const {
    return smoothstep(-blend, blend, left ? p.x() - centre.x() : centre.x() - p.x());
  }

  Vec3 centre;
  double half;                  ///< width of the mouth
  double blend;                 ///< metres from the midline over which left passes into right
  std::array<Margin, 2> edges;  ///< height and depth, of the lower lip, of the upper
};

/// A turn about the leftward axis that a channel gives a place's skin and fascia. Lips are moved, never held.
struct LipTurn {
  Vec3 origin;
  double angle = 0.0, reverse = 0.0;  // radians at a channel's value of 1 and -1
  double drive = 0.0;                 // newton per metre
};

/// Gives column `v` the turn by the channels of both sides that begin with `name`, each by its share.
void add_turn(const TissueInputs& inputs, const LipEdges& lips, const Columns& c, size_t v,
              const std::string& name, const LipTurn& turn, rig::TissueLevel& level) {
  constexpr double least = 0.02;  // of the drive of an area
  const auto n = static_cast<size_t>(c.count());
  for (const bool is_left : {true, false}) {
    const double side = lips.side(c.mesh.vertices[v], is_left);
    const int channel = channel_index(inputs.channels, name + (is_left ? "_left" : "_right"));
    if (channel < 0 || side < least) continue;
    for (const size_t node : {v, n + v}) {
      level.carrier_channel.push_back(static_cast<uint32_t>(channel));
      level.carrier_node.push_back(static_cast<uint32_t>(node));
      level.carrier_origin.push_back(turn.origin.cast<float>());
      level.carrier_axis.push_back(rig::Vec3f::UnitX());
      level.carrier_angle.push_back(static_cast<float>(turn.angle));
      level.carrier_reverse.push_back(static_cast<float>(turn.reverse));
      level.carrier_stiffness.push_back(0.0F);
      level.carrier_drive.push_back(static_cast<float>(turn.drive * side));
    }
  }
}

}  // namespace

void add_lip_turns(const TissueInputs& inputs, const FaceRegion& region, const Beneath& beneath,
                   const Columns& c, rig::TissueLevel& level) {
  constexpr double least_fade = 0.02;
  const anatomy::mechanics::Lips& m = inputs.mechanics.lips;
  const LipEdges lips(inputs, region, beneath);
  const auto& distance = c.opening_distance[static_cast<size_t>(Opening::mouth)];
  for (const bool upper : {true, false}) {
    const Margin& edge = lips.edges[upper];
    if (edge.empty()) continue;
    const double up = upper ? 1.0 : -1.0;
    const std::string lip = upper ? "upper" : "lower";
    for (size_t v = 0; v < static_cast<size_t>(c.count()); ++v) {
      const Vec3& p = c.mesh.vertices[v];
      if (c.rim[v] || (c.lower_lip[v] < 0.5) != upper) continue;
      const Eigen::Vector2d at = edge.at(lips.place_of(p));
      const double lateral = m.roll_lateral_fade.fall(lips.lateral(p));
      // The lip's body lies above (below) and behind its edge: the vermilion turns about that, the white lip
      // stays.
      if (const double fade = m.roll_fade.fall(distance[v]) * lateral; fade > least_fade) {
        LipTurn roll{Vec3(p.x(), at.x() + up * m.roll_depth, at.y() - m.roll_depth)};
        roll.angle = up * m.roll_in;
        roll.reverse = -up * m.roll_out;
        roll.drive = m.roll_drive * c.area[v] * fade;
        add_turn(inputs, lips, c, v, "lip_roll_" + lip, roll, level);
      }
      // As the sphincter's outer part contracts, the whole lip swings forward from where it hangs on the
      // bone.
      if (const double fade = m.protrusion_fade.fall(distance[v]) * lateral;
          c.outer[v] && fade > least_fade) {
        LipTurn swing{Vec3(p.x(), at.x() + up * m.protrusion_height, at.y())};
        swing.angle = upper ? -m.protrusion_upper : m.protrusion_lower;
        swing.drive = m.protrusion_drive * c.area[v] * fade;
        add_turn(inputs, lips, c, v, "orbicularis_oris_peripheral_" + lip, swing, level);
      }
    }
  }
}

namespace {

/// A column near the lips' edge.
struct LipColumn {
  size_t column;
  double place,
      share;  ///< across the mouth, 0 its right corner .. 1 its left; of the hold, by area and nearness
};

/// Adds a strand between two nodes that pulls them together.
void add_strand(const Columns& c, size_t from, size_t to, double hold, double shortest, int channel,
                uint32_t muscle, rig::TissueLevel& level) {
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
  const anatomy::mechanics::Lips& m = inputs.mechanics.lips;
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
      if (c.rim[v] || !(distance[v] < m.seal_reach) || std::abs(c.lower_lip[v] - 0.5) < corner_share ||
          place <= 0.02 || place >= 0.98 || (place > 0.5) != is_left)
        continue;
      const double nearness = 1.0 - distance[v] / m.seal_reach;
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
               (c.outer[lower.column] == c.outer[upper.column] ? 0.0 : m.seal_reach);
      };
      const auto lower = std::min_element(lips[1].begin(), lips[1].end(),
                                          [&](const auto& a, const auto& b) { return apart(a) < apart(b); });
      add_strand(c, upper.column, lower->column, m.seal_hold * upper.share / sum, m.seal_shortest, channel,
                 index, level);
    }
  }
}

}  // namespace fascia::tissue
