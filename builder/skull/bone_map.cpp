#include <algorithm>
#include <cmath>
#include <limits>

#include "builder/skull/skull.h"
#include "geometry/alignment.h"
#include "geometry/smoothstep.h"

namespace fascia::skull {

double BoneMap::Patch::strength(const Vec3& generic) const {
  double squared = std::numeric_limits<double>::infinity();
  for (const Vec3& anchor : anchors)
    squared = std::min(squared, (generic - anchor).squaredNorm());
  return smoothstep((outer - std::sqrt(squared)) / (outer - inner));
}

BoneMap::BoneMap(splines::Warp warp, std::vector<Patch> patches)
    : warp_(std::move(warp)), patches_(std::move(patches)) {}

Vec3 BoneMap::blend(const Vec3& generic, const Vec3& warped) const {
  double total = 0;
  Vec3 sum = Vec3::Zero();
  for (const Patch& patch : patches_) {
    const double w = patch.strength(generic);
    if (w <= 0) continue;
    sum += w * transform_point(patch.similarity, generic);
    total += w;
  }
  return total > 1 ? Vec3(sum / total) : Vec3(sum + (1 - total) * warped);
}

Vec3 BoneMap::operator()(const Vec3& generic) const {
  return blend(generic, warp_(generic));
}

std::vector<Vec3> BoneMap::operator()(std::span<const Vec3> generic) const {
  std::vector<Vec3> out = warp_(generic);
  for (size_t i = 0; i < out.size(); ++i)
    out[i] = blend(generic[i], out[i]);
  return out;
}

}  // namespace fascia::skull
