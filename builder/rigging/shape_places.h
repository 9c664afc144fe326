#pragma once

#include <optional>
#include <string>
#include <vector>

#include "anatomy/anatomy.h"
#include "builder/landmarks/placement.h"
#include "formats/scene.h"

namespace fascia::rigging {

/// Where a head's own morph targets say that its eyes and its mouth's corners are.
struct ShapePlaces {
  std::vector<landmarks::Anchor> anchors;  ///< four: left eye, right eye, left and right corner; file's units
  std::string mesh;                        ///< name of the mesh that the lids are part of

  /// Whether a face found elsewise stands there: its eyes and corners lie nearer to these places than a third
  /// of the eyes' distance.
  bool agree(const landmarks::Placement& placement) const;
};

/// From shapes that close one eye and raise one corner, by the names that ARKit, VRM's makers and others give
/// them, in any spelling; a place is the middle of what the shape moves, weighted by how far. Nothing when
/// one of the four is missing or damaged, or where the four cannot be a face's.
std::optional<ShapePlaces> places_by_shapes(const formats::Scene& scene,
                                            const anatomy::GenericAnatomy& anatomy);

}  // namespace fascia::rigging
