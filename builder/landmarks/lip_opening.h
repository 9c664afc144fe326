#pragma once

#include <optional>
#include <vector>

#include "builder/spatial/surface_query.h"
#include "geometry/connectivity.h"

namespace fascia::landmarks {

/// About where a mouth is.
struct MouthRegion {
  Vec3 left, right;  ///< corners
  Vec3 forward;      ///< of the head
};

/// How a skin hangs together: found once for all mouths that are looked for on it.
struct SkinLinks {
  explicit SkinLinks(const TriangleMesh& skin);
  Connectivity triangles;
  std::vector<int> component;  ///< of each triangle
};

/// The ends of the line along which the lips part.
struct LipOpening {
  Vec3 left, right;  ///< on the skin
};

/// Looks at the mouth from the front, column by column: where the way over the skin from one line of sight to
/// the one below leads through the inside of the mouth or around its corners, the lips part. Nothing where
/// they are one surface, or no run of such columns lies about the middle. `links` are those of `skin`.
std::optional<LipOpening> lip_opening(const spatial::SurfaceQuery& skin, const SkinLinks& links,
                                      const MouthRegion& mouth);

}  // namespace fascia::landmarks
