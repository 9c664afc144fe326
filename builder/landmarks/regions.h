#pragma once

#include <string>
#include <vector>

#include "builder/landmarks/registration.h"

namespace fascia::landmarks {

/// What part of the face each vertex of a skin belongs to.
struct FaceRegions {
  std::vector<std::string>
      names;  ///< lip_upper, lip_lower, mouth_lining, lid_upper_left, nostril_left, cheek, ...
  std::vector<int> of_vertex;  ///< index into `names`, -1 where the generic head has nothing near (the body)
};

/// Carries the regions of the generic head over to `skin` (the frame of `fit`): to every vertex from the
/// nearest part of the bent generic skin that faces the same way, so that lips and lids that touch stay upper
/// and lower, and lining stays lining.
FaceRegions face_regions(const GenericFace& face, const Registration& fit, const TriangleMesh& skin);

}  // namespace fascia::landmarks
