#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "anatomy/anatomy.h"
#include "builder/landmarks/find_head.h"
#include "builder/landmarks/generic_face.h"
#include "builder/landmarks/placement.h"
#include "builder/landmarks/registration.h"
#include "builder/landmarks/skin_landmark.h"
#include "geometry/landmarks.h"

namespace fascia::landmarks {

/// The required landmarks as mapped by the coarse fit, a few millimetres off the mesh, in its axes and units:
/// accurate enough to determine units, axes and parts. Those beyond the edge of a partial head are omitted.
Landmarks rough_landmarks(const GenericFace& face, const anatomy::GenericAnatomy& anatomy,
                          const FoundHead& found);

/// Eyeballs where known, in the frame of the skin.
struct KnownEyes {
  std::optional<Ball> left, right;
};

/// Landmarks, and the generic head deformed onto the skin, which maps everything else.
struct FoundFace {
  std::map<std::string, SkinLandmark> landmarks;
  Registration fit;
  std::vector<std::string> unknown;  ///< given names that the anatomy does not know; left out
};

/// All skin landmarks of `anatomy` on `skin`, the welded skin in metres, rig frame.
///
/// The generic head is registered to the skin from `start` (same frame) and deformed onto it; the corners and
/// margins of open lids are detected near the fitted eyes and constrain the fit; `given` landmarks (same
/// frame) are kept and are constraints too. The confidence of a detected landmark decreases with the residual
/// of the fit around it; one more than 8 mm beyond the edge of the mesh stays off the mesh, where the
/// deformed generic head has it, with low confidence.
FoundFace find(const GenericFace& face, const anatomy::GenericAnatomy& anatomy,
               const spatial::SurfaceQuery& skin, const Placement& start, const Landmarks& given = {},
               const KnownEyes& eyes = {});

}  // namespace fascia::landmarks
