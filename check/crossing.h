#pragma once

#include <string>
#include <vector>

#include "check/seam.h"

namespace fascia::check {

/// Penetration of one surface by another.
struct Depth {
  double most = 0.0;  ///< metres
  Vec3 place = Vec3::Zero();
  void take(const Depth& other) {
    if (other.most > most) *this = other;
  }
};

/// Penetration depth of points of a surface behind another, one per point, 0 for those that are not behind
/// it.
///
/// A place has crossed when it lies behind the nearest place of `other`, straight behind and not beside an
/// edge, no farther than `deepest` metres, its normal against the other's: farther behind or facing the same
/// way lies another part of the face. With some triangle of `around` in between it lies outside of the
/// other's flesh again, as the far side of the mouth does, and has not crossed; `around` may be empty.
std::vector<double> depths_behind(const std::vector<Vec3>& places, const std::vector<Vec3>& normals,
                                  const TriangleMesh& other, double deepest, const TriangleMesh& around = {});

/// Two patches of the skin that should not cross: vertices and triangles' middles of the one are looked for
/// behind the other.
class CrossingPair {
 public:
  /// `around`: the skin of both sides and some more.
  CrossingPair(const Skin& skin, Patch places, Patch other, Patch around, double deepest);

  /// The largest penetration in a pose beyond that at rest.
  Depth find(const std::vector<Vec3>& skin) const;

 private:
  std::vector<double> depths(const std::vector<Vec3>& skin, std::vector<Vec3>& places) const;

  Patch places_, other_, around_;
  double deepest_ = 0.0;
  std::vector<double> at_rest_;
};

/// The pairs of one head: upper and lower lip, upper and lower lids.
struct Crossings {
  struct Kind {
    std::string name;  ///< lips, lids_left, lids_right
    std::vector<CrossingPair> pairs;
  };
  std::vector<Kind> kinds;
};

/// `size` is the face's against an adult's. Openings that were not found are left out.
Crossings crossings_of(const Skin& skin, const Seam& mouth, const Seam& lids_left, const Seam& lids_right,
                       double size);

}  // namespace fascia::check
