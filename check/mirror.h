#pragma once

#include <map>
#include <string>
#include <vector>

#include "builder/spatial/surface_query.h"
#include "check/skin.h"

namespace fascia::check {

/// Places of the skin and, across the midplane, the places that are their mirror images.
///
/// The midplane begins between the landmarks of both sides and is then drawn to where the face lies on its
/// own mirror image (iterative closest points: Besl and McKay 1992), since landmarks are found with a
/// millimetre's error. The places are the landmarks and some hundred vertices of the front; one that has no
/// skin within 2.5 mm of its image, on a face that is not a mirror image itself, is left out.
class MirrorPoints {
 public:
  /// `size` is the face's against an adult's.
  MirrorPoints(const Skin& skin, const std::map<std::string, Vec3>& landmarks, double size);

  /// The difference between how far a place has moved and how far its image has, mirrored, that one place in
  /// twenty exceeds: a hair's breadth decides at the edges of lids and lips. Metres.
  double asymmetry(const std::vector<Vec3>& skin, Vec3& worst_place) const;

 private:
  void find_plane(const std::map<std::string, Vec3>& landmarks);
  void fit_plane(const spatial::SurfaceQuery& query, const std::vector<Vec3>& places, double within);

  struct Pair {
    SurfacePoint here, there;
  };
  Vec3 mirrored(const Vec3& motion) const { return motion - 2.0 * normal_.dot(motion) * normal_; }
  Vec3 image(const Vec3& place) const { return on_plane_ + mirrored(place - on_plane_); }

  const Skin& skin_;
  Vec3 normal_ = Vec3::UnitX(), on_plane_ = Vec3::Zero();  // of the midplane
  std::vector<Pair> pairs_;
};

}  // namespace fascia::check
