#pragma once

#include <span>
#include <vector>

#include "builder/skull/bone_system.h"
#include "builder/skull/exterior.h"
#include "builder/skull/skull.h"

namespace fascia::skull {

/// A point of a bone curve: a semilandmark. Only its depth under the skin is known; along the skin it slides
/// to where the map bends least.
/// P. Gunz, P. Mitteroecker, F. Bookstein. Semilandmarks in three dimensions. 2005
struct CurvePoint {
  Vec3 bone = Vec3::Zero();     ///< on the generic, m
  Vec3 outward = Vec3::Zero();  ///< unit, to the generic skin
  double depth = 0;             ///< of the generic, m, not scaled
  double deviation = 0;         ///< of the depth between people, m
  Vec3 target = Vec3::Zero();   ///< on this head
  Vec3 direction = Vec3::Zero();
  bool used = false;  ///< false where this head has no skin over it
};

/// Points every `spacing` metres along the generic's curves that have landmarks with a depth near them.
std::vector<CurvePoint> curve_points(const Generic& generic, double spacing);

/// Puts each target under the skin where the ray from `positions` along the carried outward direction leaves
/// it. Where the ray meets no skin, or skin that is not the curve's, the point is not used.
void aim(std::vector<CurvePoint>& points, std::span<const Vec3> positions, const std::vector<Mat3>& jacobians,
         const Exterior& skin, double tissue_scale, double skin_share);

/// What the points say about the bone map.
void append_observations(const std::vector<CurvePoint>& points, std::vector<Observation>& out);

}  // namespace fascia::skull
