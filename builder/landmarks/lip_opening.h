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

/// Connectivity of a skin, computed once for all searches on it.
struct SkinLinks {
  explicit SkinLinks(const TriangleMesh& skin);
  Connectivity triangles;
  std::vector<int> component;  ///< of each triangle
};

/// The ends of the line along which the lips part.
struct LipOpening {
  Vec3 left, right;  ///< on the skin
};

/// Casts rays at the mouth from the front, column by column: where the path on the skin from one hit to the
/// one below leads through the oral cavity or around the corners, the lips part. Nothing if the lips are one
/// surface, or if there is no run of such columns around the middle. `links` are those of `skin`.
std::optional<LipOpening> lip_opening(const spatial::SurfaceQuery& skin, const SkinLinks& links,
                                      const MouthRegion& mouth);

}  // namespace fascia::landmarks
