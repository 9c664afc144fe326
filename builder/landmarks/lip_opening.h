#pragma once

#include <optional>

#include "builder/spatial/surface_query.h"

namespace fascia::landmarks {

/// About where a mouth is.
struct MouthRegion {
  Vec3 left, right;  ///< corners
  Vec3 forward, up;  ///< of the head
};

/// The ends of the line along which the lips part.
struct LipOpening {
  Vec3 left, right;  ///< on the skin
};

/// Looks at the mouth from the front, column by column: where the way over the skin from one line of sight to
/// the one below leads through the inside of the mouth or around its corners, the lips part. Nothing where
/// they are one surface, or no run of such columns lies about the middle.
std::optional<LipOpening> lip_opening(const spatial::SurfaceQuery& skin, const MouthRegion& mouth);

}  // namespace fascia::landmarks
