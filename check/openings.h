#pragma once

#include <optional>

#include "check/seam.h"

namespace fascia::check {

/// How the mouth stands open in a pose.
struct MouthOpening {
  double parted_share = 0.0;  ///< of the stations, that are more than `parted` apart
  double most = 0.0;          ///< widest gap, metres
  double corner_left = 0.0,
         corner_right = 0.0;  ///< gap at 15 % of the width from that corner, over the widest
};

/// `parted`: how far two places must be apart to count as parted, metres.
MouthOpening mouth_opening(const Skin& skin, const Seam& seam, const std::vector<Vec3>& vertices,
                           double parted);

}  // namespace fascia::check
