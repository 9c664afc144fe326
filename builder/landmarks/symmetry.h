#pragma once

#include <map>
#include <optional>
#include <string>

#include "builder/landmarks/skin_landmark.h"
#include "builder/spatial/mirror_plane.h"

namespace fascia::landmarks {

using spatial::MirrorPlane;

/// The mirror plane of a face whose two sides are alike, as modelled heads have it: drawn onto the skin about
/// the landmarks between it and its mirror image. Nothing when a tenth of the
/// places tried are farther from their image than people's own asymmetry leaves them.
std::optional<MirrorPlane> mirror_plane(const std::map<std::string, SkinLandmark>& landmarks,
                                        const spatial::SurfaceQuery& skin);

/// Makes found landmarks of both sides each other's images, and puts those of the midline onto it; what was
/// given by hand stays, and so does what would leave the skin. Returns how many were moved.
int make_symmetric(const MirrorPlane& plane, const spatial::SurfaceQuery& skin,
                   std::map<std::string, SkinLandmark>& landmarks);

}  // namespace fascia::landmarks
