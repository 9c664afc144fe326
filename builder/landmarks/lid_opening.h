#pragma once

#include <optional>

#include "builder/landmarks/samples.h"

namespace fascia::landmarks {

/// About where an eye is: its corners, and the ball behind the lids.
struct EyeRegion {
  Vec3 outer, inner;  ///< corners of the palpebral fissure
  Vec3 forward, up;   ///< of the head
  Ball ball;
  double depth = 0.035;  ///< of the distance between the corners: skin so far behind the ball is an opening
};

/// The opening between the lids: its extreme points, on the margins.
struct LidOpening {
  Vec3 outer, inner, upper, lower;
};

/// Looks at the eye from the front: where the skin lies behind the eyeball's surface, or there is none, the
/// lids are open. Nothing when the lids are closed, or the eye is part of the skin.
std::optional<LidOpening> lid_opening(const spatial::SurfaceQuery& skin, const EyeRegion& eye);

}  // namespace fascia::landmarks
