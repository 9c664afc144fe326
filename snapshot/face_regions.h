#pragma once

#include <string>
#include <vector>

#include "rig/model/rig.h"
#include "snapshot/player.h"
#include "snapshot/snapshot.h"

namespace fascia::snapshot {

/// How regions are cut where nobody says.
struct RegionOptions {
  size_t vertices = 10;    ///< watched in each region, spread evenly
  double reach_mm = 28.0;  ///< skin farther than this from every landmark belongs to no region
  double tolerance_mm = 0.02;
};

/// A region of a user's own: skin about landmarks, or vertices of a mesh by number.
struct WantedRegion {
  std::string name;
  std::vector<std::string> landmarks;
  double radius_mm = 12.0;           ///< about the landmarks
  std::vector<uint32_t> vertices;    ///< instead of landmarks
  uint32_t mesh = 0, primitive = 0;  ///< of `vertices`
  double tolerance_mm = 0.0;         ///< 0: as RegionOptions says
};

/// Regions of the face by the landmarks that lie in them (forehead, brows, lids, nose, cheeks, lips, corners
/// of the mouth, chin, jaw, neck), and one for every other part that moves (teeth, tongue, eyes, hair).
/// Vertices name their mesh by its place in `meshes`.
std::vector<Region> face_regions(const std::vector<PlayedMesh>& meshes,
                                 const std::vector<rig::Landmark>& landmarks, const RegionOptions& options);

/// The regions `wanted`. Throws fascia::Error naming a region whose landmark, mesh or vertex is not there.
std::vector<Region> own_regions(const std::vector<WantedRegion>& wanted,
                                const std::vector<PlayedMesh>& meshes,
                                const std::vector<rig::Landmark>& landmarks, const RegionOptions& options);

}  // namespace fascia::snapshot
