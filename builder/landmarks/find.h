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

namespace fascia::landmarks {

/// The required landmarks where the coarse fit carries them: beside the mesh by a few millimetres, in its own
/// axes and units. Enough to tell units, axes and parts by. Those that fall beyond the edge of a mesh that is
/// part of a head are left out.
std::map<std::string, Vec3> rough_landmarks(const GenericFace& face, const anatomy::GenericAnatomy& anatomy,
                                            const FoundHead& found);

/// Eyeballs where known, in the frame of the skin.
struct KnownEyes {
  std::optional<Ball> left, right;
};

/// Landmarks, and the generic head bent onto the skin, by which anything else of it can be carried over.
struct FoundFace {
  std::map<std::string, SkinLandmark> landmarks;
  Registration fit;
  std::vector<std::string> unknown;  ///< given names that the anatomy does not know; left out
};

/// All skin landmarks of `anatomy` on `skin`, the welded skin in metres, rig frame.
///
/// The generic head settles on the skin near `start` (same frame) and is bent onto it; the corners and
/// margins of open lids are looked for where the fit says the eyes are and steer it on; `given` landmarks
/// (same frame) are kept as they are and steer it too. A found one's confidence falls with the distance that
/// the fit leaves about it; one that falls more than 8 mm beyond the edge of the mesh stays beside it, where
/// the bent generic head has it, with little confidence.
FoundFace find(const GenericFace& face, const anatomy::GenericAnatomy& anatomy,
               const spatial::SurfaceQuery& skin, const Placement& start,
               const std::map<std::string, Vec3>& given = {}, const KnownEyes& eyes = {});

}  // namespace fascia::landmarks
