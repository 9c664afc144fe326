#pragma once

#include <map>
#include <string>
#include <vector>

#include "anatomy/anatomy.h"
#include "builder/landmarks/registration.h"
#include "geometry/landmarks.h"

namespace fascia::reconstruction {

/// The generic skull as what is compared with a scanned one: points of its outer surface. Only `points` and
/// `weights` are filled; a point of the facial skeleton weighs more than one of the vault.
landmarks::GenericFace skull_points(const anatomy::GenericAnatomy& anatomy);

/// The generic skull bent onto a scanned one.
struct SkullRegistration {
  landmarks::GenericFace points;  ///< of the generic skull, its own frame
  landmarks::Registration fit;    ///< generic skull -> scan, in the scan's own axes and units
  double mean_residual = 0.0;     ///< of the points that met the scan, metres of the generic skull
  double covered_share = 0.0;     ///< of the points, those that met it
  std::vector<std::string> warnings;
};

/// Finds the skull in `scan` (any axes, any pose; `metres` a unit of length is) and bends the generic one
/// onto it: similarity by iterative closest points from many directions, then thin plates from stiff to soft.
/// `known`: points on the scan's bone by landmark name; three and more of them say where the skull is, and
/// all are held to. Throws fascia::Error when the scan has no usable triangles, or does not look like a
/// skull.
SkullRegistration register_skull(const anatomy::GenericAnatomy& anatomy, const TriangleMesh& scan,
                                 double metres, const Landmarks& known);

}  // namespace fascia::reconstruction
