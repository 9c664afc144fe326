#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "builder/spatial/surface_query.h"

namespace fascia::spatial {

/// A plane of approximate mirror symmetry of a surface.
struct MirrorPlane {
  Vec3 point = Vec3::Zero(), normal = Vec3::UnitX();  ///< normal: unit, to the left
  double distance(const Vec3& p) const { return normal.dot(p - point); }
  Vec3 foot(const Vec3& p) const { return p - distance(p) * normal; }
  Vec3 image(const Vec3& p) const { return p - 2.0 * distance(p) * normal; }
  Vec3 turned(const Vec3& way) const { return way - 2.0 * normal.dot(way) * normal; }  ///< of a direction
};

/// A plane, and how well the surface matches its mirror image.
struct MirrorFit {
  MirrorPlane plane;
  std::vector<double> apart;  ///< of the places whose image has the surface within reach: how far from it

  /// 90th percentile of `apart`; infinite if empty.
  double most_apart() const;
  /// Whether at least four in five of the tested points, and at least a dozen, have an image.
  bool covers(size_t tried) const { return apart.size() >= 12 && 5 * apart.size() >= 4 * tried; }
};

/// A millimetre of an adult's face on a face with these outer canthi; `adult_width` is the distance of the
/// adult's, metres.
inline double adult_millimetre(const Vec3& canthus_left, const Vec3& canthus_right, double adult_width) {
  return 0.001 * (canthus_left - canthus_right).norm() / adult_width;
}

/// The plane in the middle of pairs of places, each to the left and to the right; none where there are no
/// pairs or they lie on one another.
std::optional<MirrorPlane> plane_between(const std::vector<std::pair<Vec3, Vec3>>& pairs);

/// Draws `start` to where `places` on `surface`, mirrored, lie on it (iterative closest points, each pair
/// measured along the surface's normal: Chen and Medioni 1992; pairs that fit badly count less and less:
/// Beaton and Tukey 1974). Along the normal, since the front of a face hardly says by its nearest points how
/// far it lies aside. Images farther than `within` from the surface, or on its other side, say nothing.
///
/// `surface`, `places`, `within` and the result are in one unit. `start.normal` is unit; the result's has its
/// direction, more or less. What too few places determine stays as in `start`.
MirrorFit fit_mirror_plane(const SurfaceQuery& surface, const std::vector<Vec3>& places,
                           const MirrorPlane& start, double within);

}  // namespace fascia::spatial
