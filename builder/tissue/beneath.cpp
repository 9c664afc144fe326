#include "builder/tissue/beneath.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "builder/spatial/surface_query.h"
#include "builder/tissue/laplacian.h"
#include "geometry/connectivity.h"
#include "geometry/error.h"

namespace fascia::tissue {
namespace {

void append(TriangleMesh& mesh, const std::vector<Vec3>& vertices,
            const std::vector<fascia::Triangle>& triangles) {
  const int first = mesh.vertex_count();
  mesh.vertices.insert(mesh.vertices.end(), vertices.begin(), vertices.end());
  for (const fascia::Triangle& t : triangles)
    mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
}

/// Depths of the layers along the normals, and whether bone lies there.
void find_depths(const TissueInputs& inputs, const FaceRegion& region, const Bones& bones, Beneath& beneath) {
  const spatial::SurfaceQuery skin(inputs.skin), cranium(bones.cranium), mandible(bones.mandible);
  std::optional<spatial::SurfaceQuery> smas;
  if (!inputs.smas.empty()) smas.emplace(inputs.smas);
  constexpr double reach = 0.03, skip = 3e-4;
  for (size_t v = 0; v < region.mesh.vertices.size(); ++v) {
    const Vec3 p = region.mesh.vertices[v], down = -beneath.normals[v];
    const bool outer = region.outer[v];
    double thickness = reach, bone = 1.0;
    if (const auto hit = skin.first_hit(p, down, reach, skip); hit)
      thickness = std::max(hit->distance, 0.001);
    for (const auto* query : {&cranium, &mandible})
      if (const auto hit = query->first_hit(p, down, reach, skip); hit) bone = std::min(bone, hit->distance);
    // A ray may pass a thin border of bone, as under the chin: what it would stop beside lies on it all the
    // same.
    constexpr double beside = 0.0035, deepest = 0.012;
    if (outer && !(bone < thickness) && thickness >= reach)
      for (const auto* query : {&cranium, &mandible})
        if (query->closest(p + deepest * down, beside).found()) bone = deepest;
    const bool on_bone = outer && bone < thickness && bone < reach;
    const double room = on_bone ? bone : 0.8 * thickness;
    double smas_depth = std::clamp(0.45 * room, 0.0010, 0.006);
    if (smas && outer)
      if (const auto hit = smas->first_hit(p, down, 0.02, 2e-4); hit) smas_depth = hit->distance;
    smas_depth = std::min(smas_depth, outer ? 0.6 * room : std::min(0.25 * room, 0.002));
    const double inner = outer ? std::min(room, smas_depth + 0.012) : std::min(0.4 * room, 0.0035);
    beneath.bone[v] = on_bone ? 1.0 : 0.0;
    beneath.smas_depth[v] = smas_depth;
    beneath.inner_depth[v] = std::max(inner, 1.3 * smas_depth + 2e-4);
  }
}

}  // namespace

Bones bones_of(const TissueInputs& inputs) {
  Bones bones{inputs.cranium, inputs.mandible};
  if (bones.cranium.empty() || bones.mandible.empty())
    throw Error("the tissue needs a fitted cranium and mandible, and one of them is empty");
  for (const PartMesh& part : inputs.parts) {
    if (part.part == "teeth_upper" || part.part == "gums_upper")
      append(bones.cranium, part.vertices, part.triangles);
    if (part.part == "teeth_lower" || part.part == "gums_lower")
      append(bones.mandible, part.vertices, part.triangles);
  }
  return bones;
}

double edge_growth(const TissueOptions& options, double feature_distance) {
  const double t = std::clamp(feature_distance / options.edge_growth, 0.0, 1.0);
  return 1.0 + (options.edge_ratio - 1.0) * t * t * (3.0 - 2.0 * t);
}

Beneath find_beneath(const TissueInputs& inputs, const FaceRegion& region, const TissueOptions& options) {
  const size_t n = region.mesh.vertices.size();
  Beneath beneath;
  beneath.smas_depth.resize(n);
  beneath.inner_depth.resize(n);
  beneath.bone.resize(n);
  std::vector<double> lengths(n);
  for (size_t v = 0; v < n; ++v)
    lengths[v] = 0.002 * edge_growth(options, region.feature_distance[v]);
  const SurfaceSmoother smoother(region.mesh, lengths);
  beneath.normals = vertex_normals(region.mesh);
  smoother.smooth(beneath.normals);
  for (Vec3& normal : beneath.normals)
    normal.normalize();
  const Bones bones = bones_of(inputs);
  find_depths(inputs, region, bones, beneath);
  const std::vector<double> smas_limit = beneath.smas_depth, inner_limit = beneath.inner_depth;
  smoother.smooth(beneath.smas_depth);
  smoother.smooth(beneath.inner_depth);
  for (size_t v = 0; v < n; ++v) {
    beneath.smas_depth[v] = std::min(beneath.smas_depth[v], 1.3 * smas_limit[v]);
    beneath.inner_depth[v] =
        std::max(std::min(beneath.inner_depth[v], 1.15 * inner_limit[v]), 1.3 * beneath.smas_depth[v] + 2e-4);
  }
  std::vector<bool> rim(n, false);
  for (const auto& loop : boundary_loops(region.mesh, connectivity(region.mesh)))
    for (const int v : loop)
      rim[static_cast<size_t>(v)] = region.outer[static_cast<size_t>(v)];
  std::vector<double> lips = region.opening_distance[static_cast<size_t>(Opening::mouth)];
  if (lips.empty()) lips.assign(n, 1e9);
  beneath.lower_lip = lower_lip(inputs, region.mesh, region.outer, lips);
  beneath.jaw_weight = jaw_weights(region.mesh, rim, bones, {lips, beneath.lower_lip});
  return beneath;
}

}  // namespace fascia::tissue
