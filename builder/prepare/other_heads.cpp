#include <algorithm>
#include <cmath>

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

/// How another surface compares with the skin, as shares of the skin's area and extents.
struct Likeness {
  double area = 0.0, least = 0.0, most = 0.0, off = 0.0;
};

Likeness likeness(const Extent& other, const Extent& skin) {
  const Eigen::Array3d size = skin.box.size().array().max(1e-9), ratio = other.box.size().array() / size,
                       off = (other.box.centre() - skin.box.centre()).array().abs() / size;
  return {other.area / skin.area, ratio.minCoeff(), ratio.maxCoeff(), off.maxCoeff()};
}

/// As large as the skin every way, and beside it: what lies about the head, such as hair, is not.
bool is_another(const Likeness& like) {
  constexpr double alike = 0.6, apart = 0.5;
  return like.area > alike && like.least > alike && like.most < 1.0 / alike && like.off > apart;
}

/// The skin over again, a little off: hair and hoods differ more.
bool is_double(const Likeness& like) {
  constexpr double slack = 0.05;
  return std::abs(like.area - 1.0) < slack && like.least > 1.0 - slack && like.most < 1.0 + slack &&
         like.off < slack;
}

}  // namespace

void warn_of_other_heads(const formats::Scene& scene, const WeldedScene& welded, const Parts& parts,
                         std::vector<std::string>& warnings) {
  const std::vector<Extent> all = extents(welded);
  const auto skin = std::find(parts.component_parts.begin(), parts.component_parts.end(), Part::skin);
  if (skin == parts.component_parts.end()) return;
  const Extent& chosen = all[static_cast<size_t>(skin - parts.component_parts.begin())];
  for (size_t c = 0; c < all.size(); ++c) {
    if (parts.component_parts[c] == Part::skin) continue;
    const Likeness like = likeness(all[c], chosen);
    if (!is_another(like) && !is_double(like)) continue;
    const std::string &own = scene.meshes[static_cast<size_t>(chosen.mesh)].name,
                      &other = scene.meshes[static_cast<size_t>(all[c].mesh)].name;
    warnings.push_back(
        is_double(like)
            ? "the file seems to hold the skin twice: '" + other + "' lies on '" + own +
                  "', a little off; delete one of them"
            : "the file seems to hold another head ('" + other + "'): '" + own +
                  "' was taken, and the other does not move; name the one you mean with --skin, or "
                  "keep one head in a file");
    return;
  }
}

}  // namespace fascia::prepare
