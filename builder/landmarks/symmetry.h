#pragma once

#include <map>
#include <optional>
#include <string>

#include "builder/landmarks/skin_landmark.h"
#include "builder/spatial/mirror_plane.h"

namespace fascia::landmarks {

using spatial::MirrorPlane;

/// The mirror plane of a face, and how well the face lies on its own image across it.
struct FaceMirror {
  MirrorPlane plane;
  bool is_exact = false;  ///< as modelled heads are; else as people are
};

/// The mirror plane of a face whose two sides are more or less alike: drawn onto the skin about the landmarks
/// between it and its mirror image. Nothing when a tenth of the places tried are farther from their image
/// than two millimetres of an adult's face.
std::optional<FaceMirror> face_mirror(const std::map<std::string, SkinLandmark>& landmarks,
                                      const spatial::SurfaceQuery& skin);

/// Makes found landmarks of both sides each other's images, and puts those of the midline onto it; on a face
/// that is no exact mirror image, only what was found more than three millimetres of an adult's face apart.
/// What was given by hand stays, and so does what would leave the skin. Returns how many were moved.
int make_symmetric(const FaceMirror& mirror, const spatial::SurfaceQuery& skin,
                   std::map<std::string, SkinLandmark>& landmarks);

/// The least turn that leads the plane's normal to the rig frame's left.
Mat3 upright(const MirrorPlane& plane);

}  // namespace fascia::landmarks
