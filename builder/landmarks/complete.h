#pragma once

#include <map>
#include <optional>
#include <string>

#include "anatomy/anatomy.h"
#include "builder/landmarks/skin_landmark.h"
#include "builder/spatial/surface_query.h"
#include "geometry/landmarks.h"
#include "geometry/mesh.h"

namespace fascia::landmarks {

/// All skin landmarks of `anatomy` on this head: the given ones unchanged, the others mapped from the generic
/// head by the thin-plate spline through the given ones and projected onto the skin.
///
/// `skin` is the welded skin, metres, rig frame. The confidence of a mapped landmark decreases with its
/// distance from the given ones and with the distance of its projection. Given names unknown to the anatomy
/// are ignored and listed in `unknown` if not null. Throws fascia::Error naming the landmarks when required
/// ones are missing and cannot be mapped: fewer than four known ones are given, or they are coplanar.
std::map<std::string, SkinLandmark> complete(const Landmarks& given, const anatomy::GenericAnatomy& anatomy,
                                             const spatial::SurfaceQuery& skin,
                                             std::vector<std::string>* unknown = nullptr);

}  // namespace fascia::landmarks
