#pragma once

#include <optional>

#include "builder/spatial/surface_query.h"

namespace fascia::landmarks {

/// A face's midline about as a fit has it.
struct Midline {
  Vec3 sellion, menton;
  Vec3 forward;        ///< of the head; unit
  double scale = 1.0;  ///< of the head against the generic one
};

/// What of a nose the profile shows.
struct NoseProfile {
  Vec3 tip;                  ///< pronasale: the farthest forward
  std::optional<Vec3> base;  ///< subnasale: the deepest place between the tip and the lip, where there is one
};

/// Looks at the midline from the front: going down from the sellion, the first rise of the skin that falls
/// back again is the nose, whatever its size and however far the lips stand forward. Nothing where the
/// profile rises less than 4 mm of the generic head, or ends above the chin.
std::optional<NoseProfile> nose_profile(const spatial::SurfaceQuery& skin, const Midline& midline);

}  // namespace fascia::landmarks
