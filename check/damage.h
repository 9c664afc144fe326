#pragma once

#include <vector>

#include "check/skin.h"

namespace fascia::check {

/// Inverted triangles and stretched edges of the skin in a pose.
struct Damage {
  int turned = 0;  ///< triangles inverted relative to their neighbours, and turned themselves: what stays
                   ///< while a fold goes over it, as an eye does that is one surface with its lids, is sound
  int stretched = 0;     ///< edges longer than `most_stretch` times their length at rest
  double longest = 0.0;  ///< largest ratio of an edge's length to that at rest
  Vec3 turned_place = Vec3::Zero(), stretched_place = Vec3::Zero();  ///< of one turned; of the longest
};

/// Stretch ratio above which an edge is counted.
inline constexpr double most_stretch = 2.5;

/// `least_edge`: shorter edges at rest (metres) are not counted, nor triangles of no area.
Damage damage(const Skin& skin, const std::vector<Vec3>& vertices, double least_edge);

}  // namespace fascia::check
