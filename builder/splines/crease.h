#pragma once

// Creases: extremes of compression and stretch of a deformation.
//
// This work is based on:
// F. Bookstein. Creases as local features of deformation grids. 2000

#include <vector>

#include "builder/splines/warp.h"
#include "geometry/mesh.h"

namespace fascia::splines {

/// A local extreme of the length that the deformation gives a unit vector.
struct Crease {
  Vec3 point = Vec3::Zero();      ///< in the source
  Vec3 direction = Vec3::Zero();  ///< unit, across the crease, in the source
  Vec3 image = Vec3::Zero();      ///< unit, what it becomes
  double stretch = 1;             ///< |J direction|: below 1 pressed, above 1 stretched
};

struct CreaseOptions {
  int resolution = 24;   ///< grid points along the longest side of the region
  double least = 0.1;    ///< |ln stretch| that counts
  bool interior = true;  ///< leave out extremes on the region's rim
};

/// The creases of `map` in `region`, strongest |ln stretch| first: extremes of the largest and smallest
/// singular value of the Jacobian on a grid, then refined to a hundredth of a cell. To impose one instead,
/// give a DeformationLandmark its vector across and the image of it.
std::vector<Crease> find_creases(const Warp& map, const Bounds& region, const CreaseOptions& options = {});

}  // namespace fascia::splines
