#pragma once

#include <array>
#include <limits>
#include <vector>

#include "builder/spatial/surface_query.h"
#include "geometry/mesh.h"

namespace fascia::skull {

/// The outer part of a head's skin: what light from outside reaches. Mouth bags and other linings are left
/// out, because bone and teeth lie on both sides of them.
struct Exterior {
  spatial::SurfaceQuery surface;  ///< the outer part, with all vertices of the skin
  std::vector<int> triangle_of;   ///< triangle of the skin for each triangle of `surface`
  std::vector<std::array<bool, 3>>
      open_sides;                     ///< sides of `surface` where it was cut from a lining, or ends
  std::vector<bool> open_vertices;    ///< vertices on such sides
  std::vector<bool> border_vertices;  ///< vertices where the skin itself ends: the neck, the edge of a scan

  /// Closest point of the outer skin. What is nearest to a rim, such as the bone behind the meeting lips,
  /// lies behind the skin: it counts as inside.
  spatial::ClosestPoint closest(const Vec3& point,
                                double range = std::numeric_limits<double>::infinity()) const;

  /// True when `closest` lies on a side where the outer skin ends.
  bool on_rim(const spatial::ClosestPoint& closest) const;

  /// True when `closest` lies where the skin itself ends.
  bool on_border(const spatial::ClosestPoint& closest) const;
};

/// Finds the outer part of `skin` (metres, normals outward) by rays from each triangle: one is outer when at
/// least a quarter of the rays over its hemisphere escapes.
Exterior exterior(const TriangleMesh& skin);

}  // namespace fascia::skull
