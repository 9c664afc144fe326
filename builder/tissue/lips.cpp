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

}  // namespace fascia::tissue
