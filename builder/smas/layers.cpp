#include "builder/smas/layers.h"

#include <algorithm>
#include <cmath>

#include "anatomy/anatomy.h"
#include "geometry/error.h"

namespace fascia::smas {

LayerDepth::LayerDepth(const std::vector<LayerSample>& table, const anatomy::mechanics::SmasShape& shape,
                       const Landmarks& landmarks, double scale)
    : limits_(shape.depth_limits), reach_(shape.region_blend * scale) {
  for (const LayerSample& sample : table)
    for (const char* side : {"", "_left", "_right"}) {
      const auto found = landmarks.find(sample.landmark + side);
      if (found == landmarks.end()) continue;
      if (!(sample.fraction > 0.0 && sample.fraction < 1.0) || !(sample.free_depth > 0.0))
        throw Error("SMAS: layer data at '" + sample.landmark +
                    "': fraction must lie in (0, 1) and depth be positive");
      sites_.push_back({found->second, sample.fraction, sample.free_depth * scale});
    }
  if (sites_.empty())
    throw Error("SMAS: no landmark of the layer table is known; give landmarks of the face");
}

double LayerDepth::depth(const Vec3& skin, double to_bone) const {
  // Shepard's inverse-distance weights, rounded at the sites so that regions blend into each other.
  double weights = 0.0, fraction = 0.0, free_depth = 0.0;
  for (const Site& site : sites_) {
    const double d2 = (site.at - skin).squaredNorm() + 0.1 * reach_ * reach_;
    const double w = 1.0 / (d2 * d2);
    weights += w;
    fraction += w * site.fraction;
    free_depth += w * site.free_depth;
  }
  fraction /= weights;
  free_depth /= weights;
  if (!std::isfinite(to_bone)) return free_depth;
  return std::clamp(std::min(fraction * to_bone, free_depth), limits_.begin * to_bone, limits_.end * to_bone);
}

}  // namespace fascia::smas
