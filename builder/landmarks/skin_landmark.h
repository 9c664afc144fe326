#pragma once

#include <optional>

#include "builder/spatial/surface_query.h"
#include "geometry/mesh.h"

namespace fascia::landmarks {

/// A landmark on the skin of this head.
struct SkinLandmark {
  Vec3 position = Vec3::Zero();  ///< metres, on the skin; beside it where the mesh ends before
  double confidence = 1.0;       ///< 1: given by hand; less: found, or carried over from the generic head
  bool is_given = true;
};

/// The skin point that stands for a carried one: the nearest that faces as `normal` does, so that nothing
/// lands on the lining of mouth or lids; the nearest of all when none does.
std::optional<spatial::ClosestPoint> facing_point(const spatial::SurfaceQuery& skin, const Vec3& carried,
                                                  const Vec3& normal);

}  // namespace fascia::landmarks
