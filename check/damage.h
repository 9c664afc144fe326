#pragma once

#include <vector>

#include "check/skin.h"

namespace fascia::check {

/// What a pose does to the triangles and edges of the skin.
struct Damage {
  int turned = 0;        ///< triangles turned over against those about them
  int stretched = 0;     ///< edges longer than `most_stretch` times their length at rest
  double longest = 0.0;  ///< largest ratio of an edge's length to that at rest
  Vec3 turned_place = Vec3::Zero(), stretched_place = Vec3::Zero();  ///< of one turned; of the longest
};

/// Largest ratio that an edge may be stretched by before it is counted.
inline constexpr double most_stretch = 2.5;

/// `least_edge`: shorter edges at rest (metres) are not counted, nor triangles of no area.
Damage damage(const Skin& skin, const std::vector<Vec3>& vertices, double least_edge);

}  // namespace fascia::check
