#include "builder/tissue/elements.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>

#include "geometry/connectivity.h"

namespace fascia::tissue {
namespace {

using rig::NodeKind;

void add_nodes(const Columns& c, const anatomy::Mechanics& m, rig::TissueLevel& level) {
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
    const double thickness[3] = {m.skin.thickness + 0.5 * c.smas_depth[v],
                                 m.smas.thickness + 0.5 * c.inner_depth[v], m.tissue.inner_layer_thickness};
    for (size_t layer = 0; layer < 3; ++layer) {
      level.masses[layer * n + v] = static_cast<float>(m.tissue.density * c.area[v] * thickness[layer]);
      level.jaw_weights[layer * n + v] = static_cast<float>(c.jaw_weight[v]);
      if (c.rim[v]) level.kinds[layer * n + v] = NodeKind::fixed;
    }
    if (c.rim[v]) continue;
    level.kinds[2 * n + v] = !c.bone[v]              ? NodeKind::mucosa
                             : c.jaw_weight[v] > 0.0 ? NodeKind::fixed_mandible
                                                     : NodeKind::fixed_cranium;
  }
}

/// What share of the face's stiffness the thin, loose skin of the lids has.
double lid_share(const Columns& c, const anatomy::mechanics::Lids& lids, size_t v) {
  const double distance = std::min(c.opening_distance[static_cast<size_t>(Opening::eye_left)][v],
                                   c.opening_distance[static_cast<size_t>(Opening::eye_right)][v]);
  return lids.softness_share + (1.0 - lids.softness_share) * lids.softness_fade.rise(distance);
}

/// What share of it relaxed lips have.
double lip_share(const Columns& c, const anatomy::mechanics::Lips& lips, size_t v) {
  return lips.softness_share +
         (1.0 - lips.softness_share) *
             lips.softness_fade.rise(c.opening_distance[static_cast<size_t>(Opening::mouth)][v]);
}

/// An edge of the lattice's triangles.
struct Edge {
  size_t a, b;
  double length;
  std::vector<size_t> triangles;
};

std::vector<Edge> edges_of(const Columns& c) {
  std::map<std::pair<size_t, size_t>, std::vector<size_t>> triangles;
  for (size_t t = 0; t < c.mesh.triangles.size(); ++t)
    for (size_t e = 0; e < 3; ++e) {
      const auto a = static_cast<size_t>(c.mesh.triangles[t][e]),
                 b = static_cast<size_t>(c.mesh.triangles[t][(e + 1) % 3]);
      triangles[{std::min(a, b), std::max(a, b)}].push_back(t);
    }
  std::vector<Edge> edges;
  for (const auto& [ends, both] : triangles)
    edges.push_back(
        {ends.first, ends.second, (c.mesh.vertices[ends.first] - c.mesh.vertices[ends.second]).norm(), both});
  return edges;
}

/// What the crossing springs of one layer do besides carrying its shear, which depends on how long the edges
/// are and is taken off elsewhere.
struct Crossing {
  std::vector<double>
      stretch;  ///< #triangles, newton per metre: as a membrane's Young's modulus times thickness
  std::vector<double> squeeze;  ///< #columns, newton per metre: as a spring straight through the column
};

/// Springs of retinacula, which are wavy: straight at the limit strain, then stiff.
struct SpringAdder {
  rig::TissueLevel& level;
  const anatomy::mechanics::Tissue& tissue;
  void operator()(size_t a, size_t b, double stiffness) const {
    (*this)(a, b, stiffness, tissue.limit_strain);
  }
  void operator()(size_t a, size_t b, double stiffness, double limit) const {
    level.spring_nodes.push_back({static_cast<uint32_t>(a), static_cast<uint32_t>(b)});
    level.spring_stiffness.push_back(static_cast<float>(stiffness));
    level.spring_limit_strain.push_back(static_cast<float>(limit));
    level.spring_second_stiffness.push_back(static_cast<float>(tissue.stiffening * stiffness));
    level.spring_one_sided.push_back(0);
  }
};

constexpr double least_thickness = 0.001;  // metres: thinner layers would make springs too stiff to solve for

double mean(const std::vector<double>& values, size_t a, size_t b) {
  return 0.5 * (values[a] + values[b]);
}

/// Two springs across the layer under each edge, which carry its shear: of stiffness k each, inclined by the
/// angle whose cosine is edge over diagonal. `outer` and `inner` are the layer's first nodes, `is_free` tells
/// whose inner nodes may move.
template <class IsFree>
Crossing add_crossing(const Columns& c, const std::vector<Edge>& edges, const std::vector<double>& thickness,
                      const std::vector<double>& shear, size_t outer, size_t inner, const IsFree& is_free,
                      const SpringAdder& spring) {
  Crossing crossing{std::vector<double>(c.mesh.triangles.size(), 0.0),
                    std::vector<double>(thickness.size(), 0.0)};
  for (const Edge& edge : edges) {
    // Springs across a layer under an edge of no length would stand upright, and carry shear with endless
    // force.
    const double t = std::max(mean(thickness, edge.a, edge.b), least_thickness),
                 e = std::max(edge.length, 0.1 * t), diagonal = std::hypot(e, t);
    const double area = (c.area[edge.a] + c.area[edge.b]) / 6.0;  // an edge's share of its two columns
    const double along =
        mean(shear, edge.a, edge.b) * area / t;  // of each spring: its stiffness times the cosine squared
    // However steep a spring is, it is taut when the layer is sheared by its own thickness.
    const double limit = std::max(spring.tissue.limit_strain, std::hypot(e + t, t) / diagonal - 1.0);
    const double stiffness = along * diagonal * diagonal / (e * e);
    int springs = 0;
    for (const auto& [a, b] : {std::pair(edge.a, edge.b), std::pair(edge.b, edge.a)})
      if (is_free(b)) {
        spring(outer + a, inner + b, stiffness, limit);
        ++springs;
      }
    for (const size_t t0 : edge.triangles)  // Young's modulus of a net of equilateral triangles is 2/3 of the
                                            // sum over its edges
      crossing.stretch[t0] +=
          springs / 3.0 * along * e * e /
          (static_cast<double>(edge.triangles.size()) * triangle_area(c.mesh, static_cast<int>(t0)));
    for (const size_t v : {edge.a, edge.b})
      crossing.squeeze[v] += 0.5 * springs * along * t * t / (e * e);
  }
  return crossing;
}

/// Retinacula and fat: one spring straight through each column, two across under each edge; what the crossing
/// ones resist of thickening is taken off the straight ones. Returns what they resist of stretching.
std::vector<double> add_retinacula(const Columns& c, const Attachments& attachments,
                                   const anatomy::Mechanics& m, rig::TissueLevel& level) {
  const auto n = static_cast<size_t>(c.count());
  const SpringAdder spring{level, m.tissue};
  const std::vector<Edge> edges = edges_of(c);
  std::vector<double> thickness = c.smas_depth, shear(n), deep(n),
                      deep_shear(n, m.fat.deep_shear_share * m.fat.shear_modulus);
  for (size_t v = 0; v < n; ++v) {
    shear[v] = m.fat.shear_modulus * attachments.skin[v] * lid_share(c, m.lids, v);
    deep[v] = c.inner_depth[v] - c.smas_depth[v];
  }
  const auto inner_free = [&](size_t v) { return !c.rim[v] && !c.bone[v]; };
  const Crossing outer = add_crossing(
      c, edges, thickness, shear, 0, n, [](size_t) { return true; }, spring);
  const Crossing inner = add_crossing(c, edges, deep, deep_shear, n, 2 * n, inner_free, spring);
  constexpr double least_left = 0.2;  // share of a spring that stays when others bear more than all of it
  for (size_t v = 0; v < n; ++v) {
    const auto straight = [&](double modulus, double depth, double carried) {
      const double wanted = modulus * c.area[v] / std::max(depth, least_thickness);
      return std::max(wanted - carried, least_left * wanted);
    };
    spring(v, n + v, straight(m.fat.across_modulus, thickness[v], outer.squeeze[v]));
    if (inner_free(v))
      spring(n + v, 2 * n + v,
             straight(m.fat.deep_across_share * m.fat.across_modulus, deep[v], inner.squeeze[v]));
  }
  return outer.stretch;
}

/// Skin and SMAS; `carried` is what the springs between them resist of stretching, each triangle's.
void add_membranes(const Columns& c, const anatomy::Mechanics& m, const std::vector<double>& carried,
                   rig::TissueLevel& level) {
  const auto plate = [&](double modulus, double thickness) {
    const double nu = m.tissue.poisson_ratio;
    return static_cast<float>(m.tissue.bending_factor * modulus * thickness * thickness * thickness /
                              (12.0 * (1.0 - nu * nu)));
  };
  const auto n = static_cast<size_t>(c.count());
  level.poisson_ratio = static_cast<float>(m.tissue.poisson_ratio);
  level.skin_bending.assign(n, plate(m.skin.young_modulus, m.skin.thickness));
  level.smas_bending.assign(n, plate(m.smas.young_modulus, m.smas.thickness));
  constexpr double least_left = 0.25;  // share of a membrane that stays when springs bear more than all of it
  for (size_t t = 0; t < c.mesh.triangles.size(); ++t) {
    const fascia::Triangle& corners = c.mesh.triangles[t];
    double outer = 0.0, bone = 1.0, soft = 0.0, fat = 0.0;
    for (const int i : corners) {
      const auto v = static_cast<size_t>(i);
      soft += std::min(lid_share(c, m.lids, v), lip_share(c, m.lips, v)) / 3.0;
      fat += m.fat.shear_modulus * c.smas_depth[v];  // Young's modulus is three times that, of a third
      outer = c.outer[v] ? 1.0 : outer;
      bone = c.bone[v] ? bone : 0.0;
    }
    // Fat is stretched with them: half of it with each. What crossing springs resist of that is not resisted
    // twice.
    const double own = 0.5 * (soft * fat - carried[t]);
    const auto membrane = [&](double wanted) {
      return static_cast<float>(std::max(wanted + own, least_left * wanted));
    };
    level.triangles.push_back({static_cast<uint32_t>(corners[0]), static_cast<uint32_t>(corners[1]),
                               static_cast<uint32_t>(corners[2])});
    // Mucosa is thinner and softer than skin; it has no SMAS, only submucosa.
    level.skin_membrane.push_back(membrane(m.skin.young_modulus * m.skin.thickness * soft *
                                           (outer > 0.0 ? 1.0 : m.skin.mucosa_stretch_share)));
    level.smas_membrane.push_back(membrane(m.smas.young_modulus * m.smas.thickness * soft *
                                           (outer > 0.0 ? 1.0 : m.smas.submucosa_stretch_share)));
    level.volume_stiffness.push_back(
        static_cast<float>((outer > 0.0 ? 1.0 : m.fat.lining_volume_share) * m.tissue.volume_modulus));
    level.inner_volume_stiffness.push_back(
        static_cast<float>(bone > 0.0 ? 0.0 : m.tissue.inner_volume_modulus));
  }
  for (size_t v = 0; v < n; ++v) {
    const auto lid = static_cast<float>(lid_share(c, m.lids, v));
    level.skin_bending[v] *= lid * (c.outer[v] ? 1.0F : static_cast<float>(m.skin.mucosa_bending_share));
    level.smas_bending[v] *= lid * (c.outer[v] ? 1.0F : static_cast<float>(m.smas.submucosa_bending_share));
  }
}

/// Between the columns of a lip's or cheek's outer skin and those of its lining lies the same flesh: each
/// lining column hangs on three outer ones that end before it, some way to its sides however close columns
/// stand.
void add_lip_body(const TissueInputs& inputs, const Columns& c, rig::TissueLevel& level) {
  const anatomy::Mechanics& m = inputs.mechanics;
  const double middle = 0.5 * (landmark(inputs, "cheilion_left") + landmark(inputs, "cheilion_right")).x();
  constexpr double same_lip = 0.3;  // of Columns::lower_lip
  const auto n = static_cast<size_t>(c.count());
  const SpringAdder spring{level, m.tissue};
  const auto& mouth = c.opening_distance[static_cast<size_t>(Opening::mouth)];
  for (size_t v = 0; v < n; ++v) {
    if (c.outer[v] || c.rim[v] || mouth[v] > m.lips.lining_reach) continue;
    std::vector<size_t> near;
    for (size_t w = 0; w < n; ++w) {
      if (!c.outer[w] || c.rim[w] || c.bone[w] || std::abs(c.lower_lip[w] - c.lower_lip[v]) > same_lip)
        continue;
      if ((c.inner[w] - c.inner[v]).norm() < m.lips.body_reach &&
          (c.mesh.vertices[w] - c.mesh.vertices[v]).dot(c.normals[v]) < 0.0)
        near.push_back(w);
    }
    if (near.empty()) continue;
    // From the midline outward, so that both sides hang alike.
    const double outward = c.mesh.vertices[v].x() < middle ? -1.0 : 1.0;
    const Vec3 across = outward * c.normals[v].cross(Vec3::UnitY()).normalized(),
               up = outward * across.cross(c.normals[v]);
    std::map<size_t, double> share;
    for (const double angle : {0.5, 2.5944, 4.6888}) {  // thirds of a turn
      const Vec3 aim = c.inner[v] + m.lips.body_spread * (std::cos(angle) * across + std::sin(angle) * up);
      const auto nearer = [&](size_t a, size_t b) {
        return (c.inner[a] - aim).squaredNorm() < (c.inner[b] - aim).squaredNorm();
      };
      share[*std::min_element(near.begin(), near.end(), nearer)] += 1.0 / 3.0;
    }
    for (const auto& [w, part] : share)
      spring(2 * n + v, 2 * n + w,
             part * m.fat.across_modulus * c.area[v] /
                 std::max((c.inner[w] - c.inner[v]).norm(), least_thickness));
  }
}

void add_tethers(const Columns& c, const Attachments& attachments, const anatomy::Mechanics& m,
                 rig::TissueLevel& level) {
  const auto n = static_cast<size_t>(c.count());
  for (size_t v = 0; v < n; ++v) {
    if (c.rim[v]) continue;
    const double depth = std::max(c.inner_depth[v] - c.smas_depth[v], m.glide.least_depth);
    const double layer = c.area[v] / depth;
    // Bone bears what presses on it through whatever depth; planes glide the wider the deeper they are.
    const double across = c.area[v] / std::min(depth, m.glide.pressing_depth);
    level.tether_nodes.push_back(static_cast<uint32_t>(n + v));
    level.tether_normals.push_back(c.normals[v].cast<float>());
    level.tether_normal_stiffness.push_back(
        static_cast<float>(m.glide.normal_modulus * across * attachments.normal[v]));
    level.tether_tangential_stiffness.push_back(
        static_cast<float>(m.glide.shear_modulus * layer * attachments.bone[v]));
  }
  // Behind the lips the lining turns over onto the gums and is bound down there: lips hang from this fold.
  for (const auto& loop : boundary_loops(c.mesh, connectivity(c.mesh)))
    for (size_t k = 0; k < loop.size(); ++k) {
      const auto v = static_cast<size_t>(loop[k]);
      if (c.rim[v] || c.outer[v] ||
          c.opening_distance[static_cast<size_t>(Opening::mouth)][v] > m.lips.lining_reach)
        continue;
      const auto place = [&](size_t i) -> const Vec3& {
        return c.mesh.vertices[static_cast<size_t>(loop[i % loop.size()])];
      };
      const double length =
          0.5 * ((place(k + 1) - place(k)).norm() + (place(k + loop.size() - 1) - place(k)).norm());
      level.tether_nodes.push_back(static_cast<uint32_t>(v));
      level.tether_normals.push_back(c.normals[v].cast<float>());
      level.tether_normal_stiffness.push_back(static_cast<float>(m.lips.gum_hold * length));
      level.tether_tangential_stiffness.push_back(static_cast<float>(m.lips.gum_hold * length));
    }
}

}  // namespace

rig::TissueLevel make_level(const TissueInputs& inputs, const LevelOptions& wanted, const Columns& columns) {
  rig::TissueLevel level;
  level.name = wanted.name;
  const Attachments attachments = attachments_of(inputs, columns);
  add_nodes(columns, inputs.mechanics, level);
  const std::vector<double> carried = add_retinacula(columns, attachments, inputs.mechanics, level);
  add_membranes(columns, inputs.mechanics, carried, level);
  add_lip_body(inputs, columns, level);
  add_tethers(columns, attachments, inputs.mechanics, level);
  return level;
}

}  // namespace fascia::tissue
