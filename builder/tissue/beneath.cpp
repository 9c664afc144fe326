#include "builder/tissue/beneath.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "builder/spatial/surface_query.h"
#include "builder/tissue/laplacian.h"
#include "geometry/connectivity.h"
#include "geometry/error.h"
#include "geometry/smoothstep.h"

namespace fascia::tissue {
namespace {

void append(TriangleMesh& mesh, const std::vector<Vec3>& vertices,
            const std::vector<fascia::Triangle>& triangles) {
  const int first = mesh.vertex_count();
  mesh.vertices.insert(mesh.vertices.end(), vertices.begin(), vertices.end());
  for (const fascia::Triangle& t : triangles)
    mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
}

/// The least depth of the inner layer that leaves the prisms between it and the SMAS a volume, metres.
double below_smas(double smas_depth) {
  return 1.3 * smas_depth + 2e-4;
}

/// The tip of the nose, where the septal cartilage lies beneath the skin and moves with the cranium as bone
/// does (Gray's Anatomy, 41st ed.): a ball about the pronasale.
class NoseTip {
 public:
  explicit NoseTip(const TissueInputs& inputs)
      : tip_(landmark(inputs, "pronasale")), height_((tip_ - landmark(inputs, "subnasale")).norm()) {}
  /// Skin that lies on the cartilage.
  bool holds(const Vec3& p) const { return (p - tip_).norm() < 0.55 * height_; }
  /// Skin of the nose, that no jaw moves.
  bool is_nose(const Vec3& p) const { return (p - tip_).norm() < 0.9 * height_; }

 private:
  Vec3 tip_;
  double height_ = 0.0;  ///< metres to the subnasale
};

/// Depths of the layers along the normals, and whether bone lies there.
void find_depths(const TissueInputs& inputs, const FaceRegion& region, const Bones& bones, Beneath& beneath) {
  const spatial::SurfaceQuery skin(inputs.skin), cranium(bones.cranium), mandible(bones.mandible);
  std::optional<spatial::SurfaceQuery> smas;
  if (!inputs.smas.empty()) smas.emplace(inputs.smas);
  constexpr double skip = 3e-4;  // metres: past the skin a ray begins on
  const anatomy::mechanics::Depths& m = inputs.mechanics.depths;
  const double reach = m.bone_reach;
  const NoseTip nose(inputs);
  constexpr double smas_range = 0.02, smas_skip = 2e-4;  // metres along a ray
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
    if (outer && !(bone < thickness) && thickness >= reach)
      for (const auto* query : {&cranium, &mandible})
        if (query->closest(p + m.rim_depth * down, m.rim_reach).found()) bone = m.rim_depth;
    const bool on_bone = outer && bone < thickness && bone < reach;
    const double room = on_bone ? bone : m.flesh_share * thickness;
    double smas_depth = std::clamp(m.smas_share * room, m.smas_limits.begin, m.smas_limits.end);
    if (smas && outer)
      if (const auto hit = smas->first_hit(p, down, smas_range, smas_skip); hit) smas_depth = hit->distance;
    smas_depth = std::min(smas_depth, outer ? m.smas_most_share * room
                                            : std::min(m.lining_smas_share * room, m.lining_smas_most));
    const double inner =
        outer ? std::min(room, smas_depth + m.behind_smas) : std::min(m.lining_share * room, m.lining_most);
    beneath.bone[v] = on_bone || (outer && nose.holds(p)) ? 1.0 : 0.0;
    beneath.smas_depth[v] = smas_depth;
    beneath.inner_depth[v] = std::max(inner, below_smas(smas_depth));
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
  return 1.0 + (options.edge_ratio - 1.0) * smoothstep(0.0, options.edge_growth, feature_distance);
}

Beneath find_beneath(const TissueInputs& inputs, const FaceRegion& region, const TissueOptions& options) {
  const size_t n = region.mesh.vertices.size();
  Beneath beneath;
  beneath.smas_depth.resize(n);
  beneath.inner_depth.resize(n);
  beneath.bone.resize(n);
  std::vector<double> lengths(n);
  constexpr double smoothing = 0.002;  // metres beside lips and lids
  constexpr double smas_rise = 1.3,
                   inner_rise = 1.15;  // over what was found that smoothing may deepen layers
  for (size_t v = 0; v < n; ++v)
    lengths[v] = smoothing * edge_growth(options, region.feature_distance[v]);
  const SurfaceSmoother smoother(region.mesh, lengths);
  const std::vector<Vec3> own_normals = vertex_normals(region.mesh);
  beneath.normals = own_normals;
  smoother.smooth(beneath.normals);
  for (size_t v = 0; v < n; ++v) {
    // Where sheets lie back to back, what is evened out may cancel.
    Vec3& normal = beneath.normals[v];
    normal = normal.norm() > 0.05 ? Vec3(normal.normalized()) : own_normals[v];
    if (normal.isZero()) normal = Vec3::UnitZ();
  }
  const Bones bones = bones_of(inputs);
  find_depths(inputs, region, bones, beneath);
  const std::vector<double> smas_limit = beneath.smas_depth, inner_limit = beneath.inner_depth;
  smoother.smooth(beneath.smas_depth);
  smoother.smooth(beneath.inner_depth);
  for (size_t v = 0; v < n; ++v) {
    beneath.smas_depth[v] = std::min(beneath.smas_depth[v], smas_rise * smas_limit[v]);
    beneath.inner_depth[v] = std::max(std::min(beneath.inner_depth[v], inner_rise * inner_limit[v]),
                                      below_smas(beneath.smas_depth[v]));
  }
  const std::vector<double>& lips = region.opening_distance[static_cast<size_t>(Opening::mouth)];
  beneath.lower_lip = lower_lip(inputs, region.mesh, region.outer, lips);
  const NoseTip nose(inputs);
  std::vector<bool> still = region.rim;
  for (size_t v = 0; v < n; ++v)
    still[v] = still[v] || nose.is_nose(region.mesh.vertices[v]);
  beneath.jaw_weight =
      jaw_weights(region.mesh, still, bones, {lips, beneath.lower_lip}, inputs.mechanics.jaw_influence);
  return beneath;
}

}  // namespace fascia::tissue
