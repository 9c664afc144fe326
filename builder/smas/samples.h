#pragma once

#include <functional>
#include <limits>
#include <memory>
#include <vector>

#include "builder/smas/smas.h"
#include "builder/spatial/surface_query.h"

namespace fascia::smas {

/// The bones under the skin, as one for distances.
class Bones {
 public:
  /// Either bone may be null. Only what lies in `region` is looked at.
  Bones(const TriangleMesh* cranium, const TriangleMesh* mandible,
        const std::function<bool(const Vec3&)>& region);

  /// Distance to the nearer bone, negative inside one; infinite beyond `range`.
  double distance(const Vec3& point, double range = std::numeric_limits<double>::infinity()) const;

  /// Distance along the unit `direction` to the first bone, infinite beyond `range`.
  double along(const Vec3& origin, const Vec3& direction, double range) const;

 private:
  std::vector<spatial::SurfaceQuery> queries_;
};

/// A point where the depth of the SMAS is known.
struct DepthSample {
  Vec3 skin = Vec3::Zero();        ///< on the skin
  Vec3 normal = Vec3::Zero();      ///< smoothed outward unit normal there
  Vec3 zero = Vec3::Zero();        ///< where the SMAS passes
  double depth = 0.0;              ///< from skin to zero, metres
  double least = 0.0, most = 0.0;  ///< bounds of the depth that the bone sets
};

/// Depth samples over the face about `spacing` apart, where the skin is dense enough, and at each corner
/// where it is coarser.
std::vector<DepthSample> depth_samples(const FacialSkin& face, const Bones& bones, const LayerDepth& layers,
                                       double scale, double spacing);

}  // namespace fascia::smas
