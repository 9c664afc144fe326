#include <algorithm>

#include "builder/prepare/parts.h"

namespace fascia::prepare {

namespace {

struct Extent {
  Bounds box;
  double area = 0.0;
  int mesh = -1;  ///< of the first triangle
};

std::vector<Extent> extents(const WeldedScene& welded) {
  std::vector<Extent> all(static_cast<size_t>(welded.component_count));
  for (int t = 0; t < welded.surface.triangle_count(); ++t) {
    Extent& extent = all[static_cast<size_t>(welded.component[static_cast<size_t>(t)])];
    extent.area += triangle_area(welded.surface, t);
    if (extent.mesh < 0) extent.mesh = welded.triangle_mesh[static_cast<size_t>(t)];
    for (int v : welded.surface.triangles[static_cast<size_t>(t)]) {
      const Vec3& p = welded.surface.vertices[static_cast<size_t>(v)];
      extent.box.lower = extent.box.lower.cwiseMin(p);
      extent.box.upper = extent.box.upper.cwiseMax(p);
    }
  }
  return all;
}

/// As large as the skin every way, and beside it: what lies about the head, such as hair, is not.
bool is_like(const Extent& other, const Extent& skin) {
  constexpr double alike = 0.6, apart = 0.5;  // shares
  if (other.area < alike * skin.area) return false;
  const Vec3 size = skin.box.size();
  const Eigen::Array3d ratio = other.box.size().array() / size.array().max(1e-9);
  const Eigen::Array3d off = (other.box.centre() - skin.box.centre()).array().abs() / size.array().max(1e-9);
  return (ratio > alike).all() && (ratio < 1.0 / alike).all() && off.maxCoeff() > apart;
}

}  // namespace

void warn_of_other_heads(const formats::Scene& scene, const WeldedScene& welded, const Parts& parts,
                         std::vector<std::string>& warnings) {
  const std::vector<Extent> all = extents(welded);
  const auto skin = std::find(parts.component_parts.begin(), parts.component_parts.end(), Part::skin);
  if (skin == parts.component_parts.end()) return;
  const Extent& chosen = all[static_cast<size_t>(skin - parts.component_parts.begin())];
  for (size_t c = 0; c < all.size(); ++c) {
    if (parts.component_parts[c] == Part::skin || !is_like(all[c], chosen)) continue;
    const std::string &own = scene.meshes[static_cast<size_t>(chosen.mesh)].name,
                      &other = scene.meshes[static_cast<size_t>(all[c].mesh)].name;
    warnings.push_back("the file seems to hold another head ('" + other + "'): '" + own +
                       "' was taken, and the other does not move; name the one you mean with --skin, or keep "
                       "one head in a file");
    return;
  }
}

}  // namespace fascia::prepare
