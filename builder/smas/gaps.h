#pragma once

#include <functional>
#include <vector>

#include "builder/smas/front.h"

namespace fascia::smas {

/// Fills the loops of at most 24 edges that hold one of the front edges `left_over` and lie within `domain`
/// (empty: everywhere): slits where fronts met, cut ear by ear.
///
/// Based on: S. Akkouche and E. Galin, "Adaptive implicit surface polygonization using marching triangles",
/// Computer Graphics Forum 20(2), 2001, section 3.3.
void close_small_gaps(std::vector<int> left_over, const std::function<bool(const Vec3&)>& domain,
                      Front* front);

}  // namespace fascia::smas
