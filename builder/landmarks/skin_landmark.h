#pragma once

#include <optional>

#include "builder/spatial/surface_query.h"
#include "geometry/mesh.h"

namespace fascia::landmarks {

/// A landmark on the skin of this head.
struct SkinLandmark {
  Vec3 position = Vec3::Zero();  ///< metres, on the skin; off it where the mesh ends before
  double confidence = 1.0;       ///< 1: given; less: detected, or mapped from the generic head
  bool is_given = true;
};

/// Projection of a mapped point onto the skin: the nearest point with a normal compatible with `normal`, so
/// that nothing is projected onto the lining of mouth or lids; otherwise the nearest of all.
std::optional<spatial::ClosestPoint> facing_point(const spatial::SurfaceQuery& skin, const Vec3& carried,
                                                  const Vec3& normal);

}  // namespace fascia::landmarks
