#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "builder/spatial/mirror_plane.h"
#include "check/skin.h"
#include "geometry/landmarks.h"

namespace fascia::check {

/// Places of the skin and, across the midplane, the places that are their mirror images.
///
/// The midplane begins between the landmarks of both sides and is then drawn to where the face lies on its
/// own mirror image (spatial::fit_mirror_plane), since landmarks are found with a
/// millimetre's error. The places are the landmarks and some hundred vertices of the front; one that has no
/// skin within 2.5 mm of its image, on a face that is not a mirror image itself, is left out. Where lips or
/// lids meet, the image of a place of one lies as near to the other: it is looked for on its own.
class MirrorPoints {
 public:
  /// `size` is the face's against an adult's; `sides` has the Seam::Side of each vertex of the skin, or is
  /// empty.
  MirrorPoints(const Skin& skin, const Landmarks& landmarks, double size,
               const std::vector<uint8_t>& sides = {});

  /// The difference between how far a place has moved and how far its image has, mirrored, that one place in
  /// twenty exceeds: a hair's breadth decides at the edges of lids and lips. Metres.
  double asymmetry(const std::vector<Vec3>& skin, Vec3& worst_place) const;

 private:
  struct Pair {
    SurfacePoint here, there;
  };
  const Skin& skin_;
  spatial::MirrorPlane plane_;
  std::vector<Pair> pairs_;
};

}  // namespace fascia::check
