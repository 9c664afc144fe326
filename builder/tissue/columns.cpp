#include "builder/tissue/columns.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "builder/spatial/surface_query.h"
#include "builder/tissue/distance.h"
#include "geometry/connectivity.h"
#include "geometry/error.h"
#include "sim/energies.h"

namespace fascia::tissue {
namespace {

void append(TriangleMesh& mesh, const std::vector<Vec3>& vertices, const std::vector<fascia::Triangle>& triangles) {
  const int first = mesh.vertex_count();
  mesh.vertices.insert(mesh.vertices.end(), vertices.begin(), vertices.end());
  for (const fascia::Triangle& t : triangles) mesh.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
}

double blend(const FaceRegion& region, const SurfacePoint& p, const std::vector<double>& values) {
  double sum = 0.0;
  for (int k = 0; k < 3; ++k)
    sum += p.barycentric[k] *
           values[static_cast<size_t>(region.mesh.triangles[static_cast<size_t>(p.triangle)][static_cast<size_t>(k)])];
  return sum;
}

std::vector<double> target_lengths(const TissueInputs& inputs, const FaceRegion& region, const LevelOptions& level, const TissueOptions& options) {
  const Vec3 corners[] = {landmark(inputs, "cheilion_left"), landmark(inputs, "cheilion_right")};
  std::vector<double> lengths(region.mesh.vertices.size());
  for (size_t v = 0; v < lengths.size(); ++v) {
    const double t = std::clamp(region.feature_distance[v] / options.edge_growth, 0.0, 1.0);
    lengths[v] = 0.003 * (1.0 + (options.edge_ratio - 1.0) * t * t * (3.0 - 2.0 * t));
    // Where lips join, edges as long as elsewhere would bridge them.
    const Vec3& p = region.mesh.vertices[v];
    const double corner = std::min((p - corners[0]).norm(), (p - corners[1]).norm());
    lengths[v] *= options.corner_ratio + (1.0 - options.corner_ratio) * std::clamp(corner / options.corner_growth - 0.3, 0.0, 1.0);
  }
  const double scale = edge_scale_for(region.mesh, lengths, level.columns);
  for (double& length : lengths) length *= scale;
  return lengths;
}

/// Averages `values` over neighbours `passes` times.
template <class Value>
void smooth(const std::vector<std::vector<int>>& neighbours, int passes, std::vector<Value>& values) {
  for (int pass = 0; pass < passes; ++pass) {
    std::vector<Value> next = values;
    for (size_t v = 0; v < values.size(); ++v) {
      if (neighbours[v].empty()) continue;
      Value sum = values[v] * static_cast<double>(neighbours[v].size());
      for (const int n : neighbours[v]) sum += values[static_cast<size_t>(n)];
      next[v] = sum / (2.0 * static_cast<double>(neighbours[v].size()));
    }
    values = std::move(next);
  }
}

/// Depths of the layers under each column, and whether bone lies there.
void find_depths(const TissueInputs& inputs, const Bones& bones, Columns& c) {
  const spatial::SurfaceQuery skin(inputs.skin), cranium(bones.cranium), mandible(bones.mandible);
  std::optional<spatial::SurfaceQuery> smas;
  if (!inputs.smas.empty()) smas.emplace(inputs.smas);
  const auto n = static_cast<size_t>(c.count());
  constexpr double reach = 0.03, skip = 3e-4;
  for (size_t v = 0; v < n; ++v) {
    const Vec3 p = c.mesh.vertices[v], down = -c.normals[v];
    double thickness = reach, bone = 1.0;
    if (const auto hit = skin.first_hit(p, down, reach, skip); hit) thickness = std::max(hit->distance, 0.001);
    for (const auto* query : {&cranium, &mandible})
      if (const auto hit = query->first_hit(p, down, reach, skip); hit) bone = std::min(bone, hit->distance);
    // A ray may pass a thin border of bone, as under the chin: what it would stop beside lies on it all the same.
    constexpr double beside = 0.0035, deepest = 0.012;
    if (c.outer[v] && !(bone < thickness) && thickness >= reach)
      for (const auto* query : {&cranium, &mandible})
        if (query->closest(p + deepest * down, beside).found()) bone = deepest;
    c.bone[v] = c.outer[v] && bone < thickness && bone < reach;
    const double room = c.bone[v] ? bone : 0.8 * thickness;
    double smas_depth = std::clamp(0.45 * room, 0.0010, 0.006);
    if (smas && c.outer[v])
      if (const auto hit = smas->first_hit(p, down, 0.02, 2e-4); hit) smas_depth = hit->distance;
    smas_depth = std::min(smas_depth, c.outer[v] ? 0.6 * room : std::min(0.25 * room, 0.002));
    c.smas_depth[v] = smas_depth;
    const double inner = c.outer[v] ? std::min(room, smas_depth + 0.012) : std::min(0.4 * room, 0.0035);
    c.inner_depth[v] = std::max(inner, 1.3 * smas_depth + 2e-4);
  }
}

void place_layers(Columns& c) {
  const auto place = [&] {
    for (size_t v = 0; v < c.smas.size(); ++v) {
      c.smas[v] = c.mesh.vertices[v] - c.smas_depth[v] * c.normals[v];
      c.inner[v] = c.mesh.vertices[v] - c.inner_depth[v] * c.normals[v];
    }
  };
  place();
  // Where a fold is too tight for its depth the layer beneath would turn over: bring it nearer there.
  for (int pass = 0; pass < 32; ++pass) {
    std::vector<bool> shrink(c.smas.size(), false);
    bool any = false;
    for (int t = 0; t < c.mesh.triangle_count(); ++t) {
      const fascia::Triangle& k = c.mesh.triangles[static_cast<size_t>(t)];
      Vec3 corners[9];
      double depth = 0.0, inner_depth = 0.0;
      for (size_t i = 0; i < 3; ++i) {
        const auto v = static_cast<size_t>(k[i]);
        corners[i] = c.mesh.vertices[v];
        corners[3 + i] = c.smas[v];
        corners[6 + i] = c.inner[v];
        depth += c.smas_depth[v] / 3.0;
        inner_depth += (c.inner_depth[v] - c.smas_depth[v]) / 3.0;
      }
      const double outer = sim::prism_volume({0, 1, 2, 3, 4, 5}, corners), inner = sim::prism_volume({3, 4, 5, 6, 7, 8}, corners);
      const double area = triangle_area(c.mesh, t);
      if (outer > 0.25 * area * depth && inner > 0.05 * area * inner_depth) continue;
      any = true;
      for (const int v : k) {
        shrink[static_cast<size_t>(v)] = true;
        if (pass > 6) c.normals[static_cast<size_t>(v)] = (c.normals[static_cast<size_t>(v)] + 0.15 * triangle_normal(c.mesh, t)).normalized();
      }
    }
    if (!any) break;
    for (size_t v = 0; v < shrink.size(); ++v) {
      if (!shrink[v]) continue;
      c.smas_depth[v] = std::max(0.8 * c.smas_depth[v], 1e-4);
      c.inner_depth[v] = std::max(0.85 * c.inner_depth[v], 1.3 * c.smas_depth[v] + 5e-5);
    }
    place();
  }
}

}  // namespace

Bones bones_of(const TissueInputs& inputs) {
  Bones bones{inputs.cranium, inputs.mandible};
  if (bones.cranium.empty() || bones.mandible.empty())
    throw Error("the tissue needs a fitted cranium and mandible, and one of them is empty");
  for (const PartMesh& part : inputs.parts) {
    if (part.part == "teeth_upper" || part.part == "gums_upper") append(bones.cranium, part.vertices, part.triangles);
    if (part.part == "teeth_lower" || part.part == "gums_lower") append(bones.mandible, part.vertices, part.triangles);
  }
  return bones;
}

Columns make_columns(const TissueInputs& inputs, const FaceRegion& region, const LevelOptions& level,
                     const TissueOptions& options) {
  RemeshResult remeshed = remesh(region.mesh, target_lengths(inputs, region, level, options));
  Columns c;
  c.mesh = std::move(remeshed.mesh);
  c.source = std::move(remeshed.source);
  const auto n = static_cast<size_t>(c.count());
  std::vector<double> seen(region.outer.size());
  for (size_t v = 0; v < seen.size(); ++v) seen[v] = region.outer[v] ? 1.0 : 0.0;
  c.outer.resize(n);
  c.feature_distance.resize(n);
  for (auto& list : c.opening_distance) list.assign(n, 1e9);
  for (size_t v = 0; v < n; ++v) {
    c.outer[v] = blend(region, c.source[v], seen) > 0.5;
    c.feature_distance[v] = blend(region, c.source[v], region.feature_distance);
    for (size_t k = 1; k < c.opening_distance.size(); ++k)
      if (!region.opening_distance[k].empty()) c.opening_distance[k][v] = blend(region, c.source[v], region.opening_distance[k]);
  }
  c.rim.assign(n, false);
  for (const auto& loop : boundary_loops(c.mesh, connectivity(c.mesh)))
    for (const int v : loop) c.rim[static_cast<size_t>(v)] = c.outer[static_cast<size_t>(v)];
  c.area.assign(n, 0.0);
  for (int t = 0; t < c.mesh.triangle_count(); ++t)
    for (const int v : c.mesh.triangles[static_cast<size_t>(t)]) c.area[static_cast<size_t>(v)] += triangle_area(c.mesh, t) / 3.0;
  const auto neighbours = vertex_neighbours(c.mesh);
  c.normals = vertex_normals(c.mesh);
  smooth(neighbours, 2, c.normals);
  for (Vec3& normal : c.normals) normal.normalize();
  c.bone.assign(n, false);
  c.smas_depth.resize(n);
  c.inner_depth.resize(n);
  c.smas.resize(n);
  c.inner.resize(n);
  const Bones bones = bones_of(inputs);
  find_depths(inputs, bones, c);
  const std::vector<double> smas_limit = c.smas_depth, inner_limit = c.inner_depth;
  smooth(neighbours, 4, c.smas_depth);
  smooth(neighbours, 2, c.inner_depth);
  for (size_t v = 0; v < n; ++v) {
    c.smas_depth[v] = std::min(c.smas_depth[v], 1.3 * smas_limit[v]);
    c.inner_depth[v] = std::max(std::min(c.inner_depth[v], 1.15 * inner_limit[v]), 1.3 * c.smas_depth[v] + 2e-4);
  }
  place_layers(c);
  const std::vector<double>& lips = c.opening_distance[static_cast<size_t>(Opening::mouth)];
  c.lower_lip = lower_lip(inputs, c.mesh, c.outer, lips);
  c.jaw_weight = jaw_weights(c.mesh, c.rim, bones, {lips, c.lower_lip});
  return c;
}

}  // namespace fascia::tissue
