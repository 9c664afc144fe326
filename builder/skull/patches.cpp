#include "builder/skull/patches.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "builder/skull/teeth.h"
#include "geometry/alignment.h"

namespace fascia::skull {
namespace {

double distance_to(const std::vector<Vec3>& points, const Vec3& from) {
  double squared = std::numeric_limits<double>::infinity();
  for (const Vec3& p : points)
    squared = std::min(squared, (p - from).squaredNorm());
  return std::sqrt(squared);
}

}  // namespace

std::vector<BoneMap::Patch> make_patches(const Generic& generic, const std::optional<Mat4>& upper_match,
                                         const std::optional<Mat4>& lower_match) {
  std::vector<BoneMap::Patch> out;
  const auto add_teeth = [&](std::vector<Vec3> anchors, const std::optional<Mat4>& fixed) {
    if (anchors.empty()) return;
    // Full strength wherever there is a tooth.
    double reach = 0.003;
    for (const TriangleMesh* mesh : {&generic.teeth_upper, &generic.teeth_lower})
      for (const Vec3& v : mesh->vertices)
        reach = std::max(reach, std::min(0.008, distance_to(anchors, v)));
    BoneMap::Patch patch{std::move(anchors), reach + 1e-6, reach + 0.012, Mat4::Identity(),
                         fixed.has_value()};
    if (fixed) patch.similarity = *fixed;
    out.push_back(std::move(patch));
  };
  std::vector<Vec3> upper = symmetric_points(generic.teeth_upper, 24),
                    lower = symmetric_points(generic.teeth_lower, 24);
  if (upper_match || lower_match) {
    add_teeth(upper, upper_match ? upper_match : lower_match);
    add_teeth(lower, lower_match ? lower_match : upper_match);
  } else {
    upper.insert(upper.end(), lower.begin(), lower.end());
    add_teeth(upper, std::nullopt);
  }
  for (const Vec3& condyle : {generic.condyle_left, generic.condyle_right})
    if ((generic.condyle_left - generic.condyle_right).norm() > 0.01)
      out.push_back({{condyle}, 0.012, 0.026, Mat4::Identity(), false});
  return out;
}

std::vector<BoneMap::Patch> settled_patches(const splines::Warp& warp,
                                            const std::vector<BoneMap::Patch>& pattern) {
  std::vector<BoneMap::Patch> patches = pattern;
  for (BoneMap::Patch& patch : patches) {
    if (patch.fixed) continue;
    std::vector<Vec3> from = patch.anchors;
    if (from.size() == 1)  // a joint: the ball around it
      for (int axis = 0; axis < 3; ++axis)
        for (double side : {-0.012, 0.012})
          from.push_back(patch.anchors[0] + side * Vec3::Unit(axis));
    patch.similarity = similarity(from, warp(std::span<const Vec3>(from)));
  }
  return patches;
}

}  // namespace fascia::skull
