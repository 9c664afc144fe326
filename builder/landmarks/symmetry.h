#pragma once

#include <map>
#include <optional>
#include <string>

#include "builder/landmarks/skin_landmark.h"
#include "builder/spatial/mirror_plane.h"

namespace fascia::landmarks {

using spatial::MirrorPlane;

/// The symmetry plane of a face, and how well the face matches its mirror image.
struct FaceMirror {
  MirrorPlane plane;
  bool is_alike = true;   ///< otherwise lopsided: the plane is the midplane, and little more
  bool is_exact = false;  ///< as in modelled heads; otherwise approximate, as in people
  double unit = 0.001;    ///< metres: a millimetre of an adult's face on this one
};

/// The symmetry plane of a face: registered between the skin around the landmarks and its mirror image. The
/// face is lopsided if a tenth of the tested points are farther from their image than two millimetres of an
/// adult's face, whose outer canthi are `adult_width` metres apart. Nothing if most points have no image.
std::optional<FaceMirror> face_mirror(const std::map<std::string, SkinLandmark>& landmarks,
                                      const spatial::SurfaceQuery& skin, double adult_width);

/// Makes detected landmarks of both sides symmetric, and moves those of the midline onto the plane; on an
/// approximately symmetric face, only those more than three millimetres of an adult's face apart. Given
/// landmarks stay, and so do those that would leave the skin. Returns the number of moved landmarks.
int make_symmetric(const FaceMirror& mirror, const spatial::SurfaceQuery& skin,
                   std::map<std::string, SkinLandmark>& landmarks);

/// The smallest rotation of the plane's normal to the rig frame's left.
Mat3 upright(const MirrorPlane& plane);

}  // namespace fascia::landmarks
