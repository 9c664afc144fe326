#pragma once

#include <cstdint>
#include <vector>

#include "builder/spatial/surface_query.h"
#include "check/skin.h"
#include "geometry/landmarks.h"

namespace fascia::check {

/// The line along which two lips or two lids meet, or stand apart, as places on the skin.
struct Seam {
  enum Side : uint8_t { none = 0, upper = 1, lower = 2 };
  std::vector<double> stations;  ///< 0 at the corner to the subject's right .. 1 at the other, rising
  std::vector<SurfacePoint> upper_edge, lower_edge;  ///< #stations, on the skin's mesh at rest
  std::vector<uint8_t> sides;                        ///< of each vertex of the skin
  bool are_shut = false;  ///< two lids that meet all along at rest, moved by anything or not
  bool empty() const { return stations.empty(); }
};

/// Which lip or lid each vertex of the skin within `reach` metres of `centre` is of: the one whose middle,
/// `upper` or `lower`, is nearer along the surface. They hang together at their corners alone, so this holds
/// whatever their form and also inside of the opening. `with_still`: also over what nothing moves.
std::vector<uint8_t> sides_of_opening(const Skin& skin, const Vec3& upper, const Vec3& lower,
                                      const Vec3& centre, double reach, bool with_still = false);

/// Rays that look at an opening along one station, from its upper end to its lower.
struct Look {
  std::vector<Vec3> origins;     ///< metres
  std::vector<Vec3> directions;  ///< unit
  double reach = 0.0;            ///< metres: what is farther off is not looked at
  double jump =
      0.0;  ///< metres: where two neighbouring rays end so much apart, something lies before the rest
};

/// The two edges that `look` finds: the last place of the upper side before the opening begins, and the first
/// of the lower side after it. Returns false when it does not see both.
bool find_edges(const spatial::SurfaceQuery& query, const TriangleMesh& mesh,
                const std::vector<uint8_t>& sides, const Look& look, SurfacePoint& upper,
                SurfacePoint& lower);

/// The seam of the lips: seen from the front, 39 stations between the cheilia. `size` is the face's size
/// against an adult's.
Seam mouth_seam(const Skin& skin, const Landmarks& landmarks, double size);

/// The seam of an eye's lids, seen from outside toward the eye's centre; nine stations between the canthi. An
/// eye that is one surface with its lids and that nothing moves is no lid; lids that are shut are, though
/// nothing moves them.
Seam lid_seam(const Skin& skin, const Landmarks& landmarks, const Eye& eye, bool left);

}  // namespace fascia::check
