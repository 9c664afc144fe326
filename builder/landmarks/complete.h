#pragma once

#include <map>
#include <optional>
#include <string>

#include "anatomy/anatomy.h"
#include "builder/landmarks/skin_landmark.h"
#include "builder/spatial/surface_query.h"
#include "geometry/mesh.h"

namespace fascia::landmarks {

/// All skin landmarks of `anatomy` on this head: the given ones as they are, the others carried over from the
/// generic head by the thin-plate spline through the given ones and put on the skin.
///
/// `skin` is the welded skin, metres, rig frame. A carried landmark's confidence falls with its distance from
/// the given ones and with how far from the skin the spline left it. Given names that the anatomy does not
/// know are kept out and listed in `unknown` when not null. Throws fascia::Error naming the landmarks when
/// required ones are missing and cannot be carried over: fewer than four known ones are given, or they lie in
/// one plane.
std::map<std::string, SkinLandmark> complete(const std::map<std::string, Vec3>& given,
                                             const anatomy::GenericAnatomy& anatomy,
                                             const spatial::SurfaceQuery& skin,
                                             std::vector<std::string>* unknown = nullptr);

}  // namespace fascia::landmarks
