#include "builder/skull/coverage.h"

#include <algorithm>

#include "geometry/connectivity.h"

namespace fascia::skull {
namespace {

constexpr double beyond_rim = 0.008;  // m past the edge of the scan
constexpr double small_share = 0.01;  // less is a gap, not a part that is missing

bool arrives_on_skin(const Exterior& skin, const Vec3& carried) {
  const spatial::ClosestPoint closest = skin.surface.closest(carried);
  return closest.distance < beyond_rim || !skin.on_border(closest);
}

}  // namespace

Coverage coverage(const Generic& generic, const Bones& bones, const splines::Warp& to_head,
                  const Exterior& skin) {
  Coverage out;
  const std::array<const TriangleMesh*, 4> meshes{&generic.cranium, &generic.mandible, &generic.teeth_upper,
                                                  &generic.teeth_lower};
  std::vector<Vec3> feet;
  for (size_t v = 0; v < bones.generic.size(); ++v)
    feet.push_back(bones.over[v].outward.isZero() ? bones.generic[v] : bones.over[v].skin);
  const std::vector<Vec3> carried = to_head(std::span<const Vec3>(feet));
  std::vector<bool> on_skin(carried.size(), true);
  if (!generic.skin.empty())
    for (size_t v = 0; v < carried.size(); ++v)
      on_skin[v] = arrives_on_skin(skin, carried[v]);
  double all = 0, lost = 0;  // m^2
  for (size_t k = 0; k < 4; ++k)
    for (int at = 0; at < meshes[k]->triangle_count(); ++at) {
      int corners = 0;
      for (int corner : meshes[k]->triangles[static_cast<size_t>(at)])
        corners += on_skin[static_cast<size_t>(bones.first[k] + corner)];
      out.covered[k].push_back(corners > 0);
      const double area = triangle_area(*meshes[k], at);
      all += area;
      if (corners == 0) lost += area;
    }
  out.uncovered_share = all > 0 ? lost / all : 0;
  if (out.uncovered_share < small_share) {
    for (std::vector<bool>& part : out.covered)
      part.assign(part.size(), true);
    out.uncovered_share = 0;
  }
  return out;
}

void trim(const Coverage& coverage, FitResult& out) {
  const std::array<TriangleMesh*, 4> meshes{&out.cranium, &out.mandible, &out.teeth_upper, &out.teeth_lower};
  for (size_t k = 0; k < 4; ++k) {
    const std::vector<bool>& keep = coverage.covered[k];
    const auto kept = static_cast<size_t>(std::count(keep.begin(), keep.end(), true));
    if (kept == keep.size() || kept * 10 < keep.size()) continue;
    *meshes[k] = submesh(*meshes[k], keep, nullptr);
  }
}

}  // namespace fascia::skull
