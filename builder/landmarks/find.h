#pragma once

#include <map>
#include <string>
#include <vector>

#include "anatomy/anatomy.h"
#include "builder/landmarks/find_head.h"
#include "builder/landmarks/generic_face.h"
#include "builder/landmarks/placement.h"
#include "builder/landmarks/registration.h"
#include "builder/landmarks/skin_landmark.h"

namespace fascia::landmarks {

/// Skin landmarks of the generic head as they lie on `mesh` by a coarse fit from where it was found; on the mesh, its own
/// axes and units, a few millimetres off. Enough to tell units, axes and parts by.
std::map<std::string, Vec3> rough_landmarks(const GenericFace& face, const anatomy::GenericAnatomy& anatomy,
                                            const TriangleMesh& mesh, const FoundHead& found);

/// All skin landmarks of `anatomy` on `skin`, the welded skin in metres, rig frame.
///
/// The generic head is bent onto the skin from `placement` (same frame); `given` landmarks (same frame) are kept as
/// they are and steer the fit. A found one's confidence falls with the distance that the fit leaves about it. Given names that
/// the anatomy does not know are kept out and listed in `unknown` when not null.
std::map<std::string, SkinLandmark> find(const GenericFace& face, const anatomy::GenericAnatomy& anatomy,
                                         const spatial::SurfaceQuery& skin, const Placement& placement,
                                         const std::map<std::string, Vec3>& given = {},
                                         std::vector<std::string>* unknown = nullptr);

}  // namespace fascia::landmarks
