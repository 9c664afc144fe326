#include "builder/tissue/elements.h"

#include <algorithm>
#include <limits>
#include <set>

#include "geometry/connectivity.h"

namespace fascia::tissue {
namespace {

using rig::NodeKind;

void add_nodes(const Columns& c, const TissueMaterial& m, rig::TissueLevel& level) {
  const auto n = static_cast<size_t>(c.count());
  level.columns = static_cast<uint32_t>(n);
  level.rest.resize(3 * n);
  level.kinds.assign(3 * n, NodeKind::free);
  level.masses.resize(3 * n);
  level.jaw_weights.resize(3 * n);
  for (size_t v = 0; v < n; ++v) {
    level.rest[v] = c.mesh.vertices[v].cast<float>();
    level.rest[n + v] = c.smas[v].cast<float>();
    level.rest[2 * n + v] = c.inner[v].cast<float>();
    const double thickness[3] = {m.skin_thickness + 0.5 * c.smas_depth[v],
                                 m.smas_thickness + 0.5 * (c.inner_depth[v] - 0.0), 0.002};
    for (size_t layer = 0; layer < 3; ++layer) {
      level.masses[layer * n + v] = static_cast<float>(m.density * c.area[v] * thickness[layer]);
      level.jaw_weights[layer * n + v] = static_cast<float>(c.jaw_weight[v]);
      if (c.rim[v]) level.kinds[layer * n + v] = NodeKind::fixed;
    }
    if (c.rim[v]) continue;
    level.kinds[2 * n + v] = !c.bone[v] ? NodeKind::mucosa
                             : c.jaw_weight[v] > 0.0 ? NodeKind::fixed_mandible : NodeKind::fixed_cranium;
  }
}

double smoothstep(double low, double high, double x) {
  const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

/// Skin of the lids is the body's thinnest, some 0.5 mm, and loose: what share of the face's stiffness it has.
double lid_share(const Columns& c, size_t v) {
  const double distance = std::min(c.opening_distance[static_cast<size_t>(Opening::eye_left)][v],
                                   c.opening_distance[static_cast<size_t>(Opening::eye_right)][v]);
  return 0.04 + 0.96 * smoothstep(0.008, 0.016, distance);
}

/// Relaxed lips are softer than the face around them: what share of its stiffness they have.
double lip_share(const Columns& c, size_t v) {
  return 0.3 + 0.7 * smoothstep(0.006, 0.022, c.opening_distance[static_cast<size_t>(Opening::mouth)][v]);
}

void add_membranes(const Columns& c, const TissueMaterial& m, rig::TissueLevel& level) {
  const auto plate = [&](double modulus, double thickness) {
    const double nu = static_cast<double>(level.poisson_ratio);
    return static_cast<float>(m.bending_factor * modulus * thickness * thickness * thickness / (12.0 * (1.0 - nu * nu)));
  };
  const auto n = static_cast<size_t>(c.count());
  level.skin_bending.assign(n, plate(m.skin_modulus, m.skin_thickness));
  level.smas_bending.assign(n, plate(m.smas_modulus, m.smas_thickness));
  for (const fascia::Triangle& t : c.mesh.triangles) {
    bool outer = false, bone = true;
    double soft = 1.0;
    for (const int v : t) {
      soft = std::min({soft, lid_share(c, static_cast<size_t>(v)), lip_share(c, static_cast<size_t>(v))});
      outer = outer || c.outer[static_cast<size_t>(v)];
      bone = bone && c.bone[static_cast<size_t>(v)];
    }
    level.triangles.push_back({static_cast<uint32_t>(t[0]), static_cast<uint32_t>(t[1]), static_cast<uint32_t>(t[2])});
    // Mucosa is thinner and softer than skin; it has no SMAS, only submucosa.
    level.skin_membrane.push_back(static_cast<float>(m.skin_modulus * m.skin_thickness * soft * (outer ? 1.0 : 0.35)));
    level.smas_membrane.push_back(static_cast<float>(m.smas_modulus * m.smas_thickness * soft * (outer ? 1.0 : 0.25)));
    level.volume_stiffness.push_back(static_cast<float>(outer ? m.volume_modulus : 0.2 * m.volume_modulus));
    level.inner_volume_stiffness.push_back(static_cast<float>(bone ? 0.0 : m.inner_volume_modulus));
  }
  for (size_t v = 0; v < n; ++v) {
    const auto lid = static_cast<float>(lid_share(c, v));
    level.skin_bending[v] *= lid * (c.outer[v] ? 1.0F : 0.3F);
    level.smas_bending[v] *= lid * (c.outer[v] ? 1.0F : 0.2F);
  }
}

struct SpringAdder {
  rig::TissueLevel& level;
  void operator()(size_t a, size_t b, double stiffness) const {
    level.spring_nodes.push_back({static_cast<uint32_t>(a), static_cast<uint32_t>(b)});
    level.spring_stiffness.push_back(static_cast<float>(stiffness));
    level.spring_limit_strain.push_back(0.4F);  // retinacula are wavy: straight at some 40 %, then stiff
    level.spring_second_stiffness.push_back(static_cast<float>(4.0 * stiffness));
    level.spring_one_sided.push_back(0);
  }
};

/// Retinacula: one spring straight through each column, two across under each edge. The crossing pair carries
/// the layer's shear: of stiffness k each, inclined by the angle whose cosine is edge over diagonal.
void add_retinacula(const Columns& c, const Attachments& attachments, const TissueMaterial& m, rig::TissueLevel& level) {
  const auto n = static_cast<size_t>(c.count());
  const SpringAdder spring{level};
  const auto inner_free = [&](size_t v) { return !c.rim[v] && !c.bone[v]; };
  for (size_t v = 0; v < n; ++v) {
    spring(v, n + v, m.fat_modulus * c.area[v] / std::max(c.smas_depth[v], 0.001));
    if (inner_free(v))
      spring(n + v, 2 * n + v, 0.4 * m.fat_modulus * c.area[v] / std::max(c.inner_depth[v] - c.smas_depth[v], 0.001));
  }
  std::set<std::pair<size_t, size_t>> edges;
  for (const fascia::Triangle& t : c.mesh.triangles)
    for (size_t e = 0; e < 3; ++e) {
      const auto a = static_cast<size_t>(t[e]), b = static_cast<size_t>(t[(e + 1) % 3]);
      edges.insert({std::min(a, b), std::max(a, b)});
    }
  for (const auto& [a, b] : edges) {
    const double edge = (c.mesh.vertices[a] - c.mesh.vertices[b]).squaredNorm();
    const double area = (c.area[a] + c.area[b]) / 6.0;  // an edge's share of its two columns
    const auto crossing = [&](double thickness, double shear) {
      const double t = std::max(thickness, 0.001);
      return shear * area / t * (edge + t * t) / edge;  // two springs, each half, over the cosine squared
    };
    const double skin = 0.5 * (attachments.skin[a] + attachments.skin[b]) * std::min(lid_share(c, a), lid_share(c, b));
    const double k = crossing(0.5 * (c.smas_depth[a] + c.smas_depth[b]), m.fat_shear * skin);
    spring(a, n + b, k);
    spring(b, n + a, k);
    if (!inner_free(a) && !inner_free(b)) continue;
    const double deep = crossing(0.5 * (c.inner_depth[a] + c.inner_depth[b] - c.smas_depth[a] - c.smas_depth[b]), 0.5 * m.fat_shear);
    if (inner_free(b)) spring(n + a, 2 * n + b, deep);
    if (inner_free(a)) spring(n + b, 2 * n + a, deep);
  }
}

/// Between the columns of a lip's or cheek's outer skin and those of its lining lies the same flesh: each lining column hangs
/// on the three outer ones that end nearest before it.
void add_lip_body(const Columns& c, const TissueMaterial& m, rig::TissueLevel& level) {
  const auto n = static_cast<size_t>(c.count());
  const SpringAdder spring{level};
  const auto& mouth = c.opening_distance[static_cast<size_t>(Opening::mouth)];
  for (size_t v = 0; v < n; ++v) {
    if (c.outer[v] || c.rim[v] || mouth[v] > 0.03) continue;
    std::vector<std::pair<double, size_t>> near;
    for (size_t w = 0; w < n; ++w) {
      if (!c.outer[w] || c.rim[w] || c.bone[w] || std::abs(c.lower_lip[w] - c.lower_lip[v]) > 0.3) continue;
      const double distance = (c.inner[w] - c.inner[v]).norm();
      if (distance < 0.009 && (c.mesh.vertices[w] - c.mesh.vertices[v]).dot(c.normals[v]) < 0.0) near.emplace_back(distance, w);
    }
    const size_t count = std::min<size_t>(near.size(), 3);
    std::partial_sort(near.begin(), near.begin() + static_cast<std::ptrdiff_t>(count), near.end());
    for (size_t k = 0; k < count; ++k)
      spring(2 * n + v, 2 * n + near[k].second, m.fat_modulus * c.area[v] / (static_cast<double>(count) * std::max(near[k].first, 0.001)));
  }
}

void add_tethers(const Columns& c, const Attachments& attachments, const TissueMaterial& m, rig::TissueLevel& level) {
  const auto n = static_cast<size_t>(c.count());
  for (size_t v = 0; v < n; ++v) {
    if (c.rim[v]) continue;
    const double depth = std::clamp(c.inner_depth[v] - c.smas_depth[v], 0.002, 0.02);
    const double layer = c.area[v] / std::max(depth, 0.5 * m.glide_depth);
    // Bone bears what presses on it through whatever depth; planes glide the wider the deeper they are.
    const double across = c.area[v] / std::clamp(depth, 0.0025, 0.005);
    level.tether_nodes.push_back(static_cast<uint32_t>(n + v));
    level.tether_normals.push_back(c.normals[v].cast<float>());
    level.tether_normal_stiffness.push_back(static_cast<float>(m.glide_normal * across * attachments.normal[v]));
    level.tether_tangential_stiffness.push_back(static_cast<float>(m.glide_shear * layer * attachments.bone[v]));
  }
  // Behind the lips the lining turns over onto the gums and is bound down there: lips hang from this fold.
  for (const auto& loop : boundary_loops(c.mesh, connectivity(c.mesh)))
    for (const int i : loop) {
      const auto v = static_cast<size_t>(i);
      if (c.rim[v] || c.opening_distance[static_cast<size_t>(Opening::mouth)][v] > 0.03) continue;
      level.tether_nodes.push_back(static_cast<uint32_t>(v));
      level.tether_normals.push_back(c.normals[v].cast<float>());
      level.tether_normal_stiffness.push_back(static_cast<float>(m.gum_hold * c.area[v]));
      level.tether_tangential_stiffness.push_back(static_cast<float>(m.gum_hold * c.area[v]));
    }
}

}  // namespace

rig::TissueLevel make_level(const TissueInputs& inputs, const TissueOptions& options, const LevelOptions& wanted,
                            const Columns& columns) {
  rig::TissueLevel level;
  level.name = wanted.name;
  const Attachments attachments = attachments_of(inputs, columns);
  add_nodes(columns, options.material, level);
  add_membranes(columns, options.material, level);
  add_retinacula(columns, attachments, options.material, level);
  add_lip_body(columns, options.material, level);
  add_tethers(columns, attachments, options.material, level);
  return level;
}

}  // namespace fascia::tissue
