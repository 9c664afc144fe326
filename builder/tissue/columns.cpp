#include "builder/tissue/columns.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "builder/tissue/fissure.h"
#include "builder/tissue/laplacian.h"
#include "geometry/connectivity.h"
#include "geometry/slivers.h"
#include "sim/energies.h"

namespace fascia::tissue {
namespace {

template <class Value>
Value blend(const FaceRegion& region, const SurfacePoint& p, const std::vector<Value>& values) {
  Value sum = 0.0 * values[0];
  for (int k = 0; k < 3; ++k)
    sum += p.barycentric[k] *
           values[static_cast<size_t>(
               region.mesh.triangles[static_cast<size_t>(p.triangle)][static_cast<size_t>(k)])];
  return sum;
}

std::vector<double> target_lengths(const TissueInputs& inputs, const FaceRegion& region,
                                   const LevelOptions& level, const TissueOptions& options) {
  const Vec3 corners[] = {landmark(inputs, "cheilion_left"), landmark(inputs, "cheilion_right")};
  std::vector<double> lengths(region.mesh.vertices.size());
  for (size_t v = 0; v < lengths.size(); ++v) {
    lengths[v] = edge_growth(options, region.feature_distance[v]);
    // Where lips join, edges as long as elsewhere would bridge them.
    const Vec3& p = region.mesh.vertices[v];
    const double corner = std::min((p - corners[0]).norm(), (p - corners[1]).norm());
    lengths[v] *= level.corner_ratio +
                  (1.0 - level.corner_ratio) * std::clamp(corner / options.corner_growth - 0.3, 0.0, 1.0);
  }
  const double scale = edge_scale_for(region.mesh, lengths, level.columns);
  for (double& length : lengths)
    length *= scale;
  return lengths;
}

/// Moves the vertex nearest to each place of the lids' edges onto it, where that turns no triangle: an edge
/// between two rows of columns would be cut off, and lids that meet would meet beside it.
void settle_on_lid_edges(const TissueInputs& inputs, const FaceRegion& region, RemeshResult& remeshed) {
  TriangleMesh& mesh = remeshed.mesh;
  const auto around = triangles_around(mesh);
  std::vector<double> moved(mesh.vertices.size(), 1e9);
  std::vector<Vec3> before = mesh.vertices;
  const std::vector<double> areas = vertex_areas(mesh);
  for (const bool left : {true, false}) {
    const Fissure fissure(inputs, region, left);
    for (const SurfacePoint& place : fissure.edges()) {
      const Vec3 there = position(region.mesh, place);
      size_t nearest = 0;
      for (size_t v = 1; v < before.size(); ++v)
        if ((before[v] - there).squaredNorm() < (before[nearest] - there).squaredNorm()) nearest = v;
      const double way = (before[nearest] - there).norm();
      if (way > 0.7 * std::sqrt(areas[nearest]) || way > moved[nearest]) continue;
      const Vec3 here = mesh.vertices[nearest];
      bool is_sound = true;
      std::vector<std::pair<Vec3, double>> old;
      for (const int t : around[nearest])
        old.emplace_back(triangle_normal(mesh, t), triangle_area(mesh, t));
      mesh.vertices[nearest] = there;
      for (size_t k = 0; k < old.size(); ++k) {
        const int t = around[nearest][k];
        is_sound = is_sound && triangle_normal(mesh, t).dot(old[k].first) > 0.3 &&
                   triangle_area(mesh, t) > 0.3 * old[k].second;
      }
      if (is_sound) {
        moved[nearest] = way;
        remeshed.source[nearest] = place;
      } else {
        mesh.vertices[nearest] = here;
      }
    }
  }
}

/// A triangle without height has no strain to measure: such are taken out, with what only they hold.
void drop_slivers(RemeshResult& remeshed) {
  constexpr double lowest = 1e-4;  // metres, where edges are some 0.5 mm and longer
  std::vector<int> map;
  TriangleMesh sound = without_slivers(remeshed.mesh, lowest, &map);
  std::vector<SurfacePoint> source(sound.vertices.size());
  for (size_t v = map.size(); v-- > 0;)  // of vertices that became one the first gave its place
    if (map[v] >= 0) source[static_cast<size_t>(map[v])] = remeshed.source[v];
  remeshed = {std::move(sound), std::move(source)};
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
      const double outer = sim::prism_volume({0, 1, 2, 3, 4, 5}, corners),
                   inner = sim::prism_volume({3, 4, 5, 6, 7, 8}, corners);
      const double area = triangle_area(c.mesh, t);
      if (outer > 0.25 * area * depth && inner > 0.05 * area * inner_depth) continue;
      any = true;
      for (const int v : k) {
        shrink[static_cast<size_t>(v)] = true;
        if (pass > 6)
          c.normals[static_cast<size_t>(v)] =
              (c.normals[static_cast<size_t>(v)] + 0.15 * triangle_normal(c.mesh, t)).normalized();
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

/// A cut of the region, and of a mirrored one of each image, which come last, the vertex that it is one of.
struct Cut {
  RemeshResult remeshed;
  std::vector<size_t> left;
};

/// The region cut anew with the edge lengths that `level` wants.
Cut cut_anew(const TissueInputs& inputs, const FaceRegion& region, const std::vector<double>& lower_lip,
             const std::optional<Symmetry>& symmetry, const LevelOptions& level,
             const TissueOptions& options) {
  const std::vector<double> lengths = target_lengths(inputs, region, level, options);
  const auto finished = [&](RemeshResult remeshed) {
    settle_on_lid_edges(inputs, region, remeshed);
    drop_slivers(remeshed);
    return remeshed;
  };
  if (symmetry) {
    const HalfRegion half = left_half(region.mesh, *symmetry);
    std::vector<double> half_lengths;
    for (const SurfacePoint& place : half.source)
      half_lengths.push_back(blend(region, place, lengths));
    const RemeshResult own = finished(on_region(remesh(half.mesh, half_lengths), half, *symmetry));
    Symmetry tried = *symmetry;
    for (const bool is_exact : {true, false}) {  // where it is exact but for a part, as the mouth's lining
      if (is_exact && !symmetry->is_exact) continue;
      tried.is_exact = is_exact;
      Cut cut;
      auto full = with_images(own, region, lower_lip, tried, cut.left);
      if (!full) continue;
      cut.remeshed = is_exact ? std::move(*full) : finished(std::move(*full));
      if (!is_exact) cut.left.clear();
      return cut;
    }
  }
  return {finished(remesh(region.mesh, lengths)), {}};
}

/// Makes what the columns are like the same on both sides.
void take_from_left(const Symmetry& symmetry, const std::vector<size_t>& left, Columns& c) {
  const auto n = static_cast<size_t>(c.count());
  const size_t first = n - left.size();
  const auto copy = [&](auto& values) {
    for (size_t k = 0; k < left.size(); ++k)
      values[first + k] = values[left[k]];
  };
  for (auto* list : {&c.smas_depth, &c.inner_depth, &c.lower_lip, &c.jaw_weight, &c.feature_distance})
    copy(*list);
  for (auto* list : {&c.outer, &c.rim, &c.bone})
    copy(*list);
  for (const Opening opening : {Opening::mouth, Opening::nostril})
    copy(c.opening_distance[static_cast<size_t>(opening)]);
  std::vector<double>& eye_left = c.opening_distance[static_cast<size_t>(Opening::eye_left)];
  std::vector<double>& eye_right = c.opening_distance[static_cast<size_t>(Opening::eye_right)];
  std::vector<bool> has_image(first, false);
  for (size_t k = 0; k < left.size(); ++k) {
    eye_left[first + k] = eye_right[left[k]];
    eye_right[first + k] = eye_left[left[k]];
    c.normals[first + k] = symmetry.turned(c.normals[left[k]]);
    has_image[left[k]] = true;
  }
  for (size_t v = 0; v < first; ++v) {
    const Vec3 flat = c.normals[v] - symmetry.normal.dot(c.normals[v]) * symmetry.normal;
    if (!has_image[v] && flat.norm() > 0.1) c.normals[v] = flat.normalized();
  }
}

/// The columns at the places of `remeshed`, without areas and layers.
Columns columns_at(const FaceRegion& region, const Beneath& beneath, RemeshResult remeshed) {
  Columns c;
  c.mesh = std::move(remeshed.mesh);
  c.source = std::move(remeshed.source);
  const auto n = static_cast<size_t>(c.count());
  std::vector<double> seen(region.outer.size());
  for (size_t v = 0; v < seen.size(); ++v)
    seen[v] = region.outer[v] ? 1.0 : 0.0;
  c.outer.resize(n);
  c.feature_distance.resize(n);
  for (auto& list : c.opening_distance)
    list.assign(n, 1e9);
  for (size_t v = 0; v < n; ++v) {
    c.outer[v] = blend(region, c.source[v], seen) > 0.5;
    c.feature_distance[v] = blend(region, c.source[v], region.feature_distance);
    for (size_t k = 1; k < c.opening_distance.size(); ++k)
      c.opening_distance[k][v] = blend(region, c.source[v], region.opening_distance[k]);
  }
  c.rim.assign(n, false);
  std::vector<double> ends(region.rim.size());
  for (size_t v = 0; v < ends.size(); ++v)
    ends[v] = region.rim[v] ? 1.0 : 0.0;
  for (const auto& loop : boundary_loops(c.mesh, connectivity(c.mesh)))
    for (const int i : loop) {
      const auto v = static_cast<size_t>(i);
      c.rim[v] = c.outer[v] && blend(region, c.source[v], ends) > 0.25;
    }
  const std::vector<Vec3> own_normals = vertex_normals(c.mesh);
  c.normals.resize(n);
  c.bone.resize(n);
  for (auto* list : {&c.smas_depth, &c.inner_depth, &c.lower_lip, &c.jaw_weight})
    list->resize(n);
  for (size_t v = 0; v < n; ++v) {
    c.normals[v] = blend(region, c.source[v], beneath.normals);
    c.normals[v] = c.normals[v].norm() > 1e-6 ? Vec3(c.normals[v].normalized()) : own_normals[v];
    c.bone[v] = c.outer[v] && blend(region, c.source[v], beneath.bone) > 0.5;
    c.smas_depth[v] = blend(region, c.source[v], beneath.smas_depth);
    c.inner_depth[v] = blend(region, c.source[v], beneath.inner_depth);
    c.lower_lip[v] = blend(region, c.source[v], beneath.lower_lip);
    c.jaw_weight[v] = c.rim[v] ? 0.0 : blend(region, c.source[v], beneath.jaw_weight);
  }
  return c;
}

}  // namespace

Columns make_columns(const TissueInputs& inputs, const FaceRegion& region, const Beneath& beneath,
                     const std::optional<Symmetry>& symmetry, const LevelOptions& level,
                     const TissueOptions& options) {
  Cut cut = cut_anew(inputs, region, beneath.lower_lip, symmetry, level, options);
  Columns c = columns_at(region, beneath, std::move(cut.remeshed));
  if (!cut.left.empty()) take_from_left(*symmetry, cut.left, c);
  c.area = vertex_areas(c.mesh);
  c.smas.resize(c.mesh.vertices.size());
  c.inner.resize(c.mesh.vertices.size());
  place_layers(c);
  return c;
}

}  // namespace fascia::tissue
