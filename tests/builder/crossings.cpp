#include "tests/builder/crossings.h"

#include <algorithm>
#include <array>
#include <optional>

#include "builder/spatial/surface_query.h"
#include "geometry/connectivity.h"

namespace fascia::testing {
namespace {

constexpr double deepest = 0.003;  // metres: what has crossed farther has neighbours that are less deep;
                                   // farther behind lies another part of the face

/// One side of an opening as a mesh of its own.
struct SideSurface {
  TriangleMesh mesh;
  Connectivity links;
  std::vector<bool> on_border;  ///< #vertices

  SideSurface(const TriangleMesh& whole, const std::vector<uint8_t>& sides, uint8_t side) {
    std::vector<bool> keep(whole.triangles.size());
    for (size_t t = 0; t < keep.size(); ++t) {
      const Triangle& k = whole.triangles[t];
      keep[t] = std::all_of(k.begin(), k.end(), [&](int v) { return sides[static_cast<size_t>(v)] == side; });
    }
    mesh = submesh(whole, keep, nullptr);
    links = connectivity(mesh);
    on_border.resize(mesh.vertices.size());
    for (size_t t = 0; t < mesh.triangles.size(); ++t)
      for (size_t e = 0; e < 3; ++e)
        if (links.neighbours[t][e] < 0)
          for (const size_t k : {e, (e + 1) % 3})
            on_border[static_cast<size_t>(mesh.triangles[t][k])] = true;
  }

  /// Whether a place lies on the border, where there is no telling the surface's sides apart.
  bool is_border(const SurfacePoint& p) const {
    const auto t = static_cast<size_t>(p.triangle);
    for (size_t k = 0; k < 3; ++k) {
      const double weight = p.barycentric[static_cast<int>(k)];
      if (weight > 1.0 - 1e-6) return on_border[static_cast<size_t>(mesh.triangles[t][k])];
      if (weight < 1e-6 && links.neighbours[t][(k + 1) % 3] < 0) return true;
    }
    return false;
  }
};

}  // namespace

std::vector<uint8_t> column_sides(const rig::TissueLevel& level, int rings) {
  std::vector<uint8_t> sides(level.columns, no_side);
  for (size_t f = 0; f < level.facing_prism.size(); ++f)
    for (const uint32_t column : level.triangles[level.facing_prism[f]])
      sides[column] = level.facing_side[f];
  for (int ring = 0; ring < rings; ++ring) {
    std::vector<std::array<int, 6>> votes(level.columns, std::array<int, 6>{});
    for (const auto& t : level.triangles)
      for (const uint32_t from : t)
        for (const uint32_t to : t)
          if (sides[from] < 2 && sides[to] == no_side) ++votes[to][sides[from]];
    for (uint32_t c = 0; c < level.columns; ++c) {
      const auto best = std::max_element(votes[c].begin(), votes[c].end());
      if (*best > 0) sides[c] = static_cast<uint8_t>(best - votes[c].begin());
    }
  }
  return sides;
}

std::vector<uint8_t> vertex_sides(const rig::Binding& binding, const rig::TissueLevel& level) {
  const std::vector<uint8_t> columns = column_sides(level, 1);
  std::vector<uint8_t> sides(binding.vertex_count, no_side);
  for (uint32_t v = 0; v < binding.vertex_count; ++v) {
    std::array<float, 6> share{};
    for (uint32_t k = v * binding.influences; k < (v + 1) * binding.influences; ++k)
      if (binding.nodes[k] < level.columns && columns[binding.nodes[k]] != no_side)
        share[columns[binding.nodes[k]]] += binding.weights[k];
    const auto best = std::max_element(share.begin(), share.end());
    if (*best > 0.75F) sides[v] = static_cast<uint8_t>(best - share.begin());
  }
  return sides;
}

Crossings::Crossings(const TriangleMesh& mesh, const std::vector<uint8_t>& sides) {
  std::vector<int> map;
  welded_ = weld(mesh, 1e-7, &map);
  source_.assign(welded_.vertices.size(), -1);
  sides_.assign(welded_.vertices.size(), no_side);
  for (size_t v = 0; v < map.size(); ++v) {
    const int w = map[v];
    if (w < 0 || source_[static_cast<size_t>(w)] >= 0) continue;
    source_[static_cast<size_t>(w)] = static_cast<int>(v);
    sides_[static_cast<size_t>(w)] = sides[v];
  }
  // What lies behind the other side at rest, as the far side of a corner, cannot cross it.
  constexpr double known = 1e-3;
  for (int opening = 0; opening < 3; ++opening) {
    at_rest_.emplace_back();
    at_rest_.back() = depths(mesh.vertices, opening);
    std::vector<bool> behind(welded_.vertices.size());
    for (const int which : {0, 1}) {
      const auto side = static_cast<uint8_t>(2 * opening + which);
      const SideSurface facing(welded_, sides_, static_cast<uint8_t>(side ^ 1));
      if (facing.mesh.triangles.empty()) continue;
      const spatial::SurfaceQuery query(facing.mesh);
      for (size_t v = 0; v < behind.size(); ++v)
        behind[v] = behind[v] || (sides_[v] == side &&
                                  query.closest(welded_.vertices[v], deepest).signed_distance < -known);
    }
    for (size_t v = 0; v < behind.size(); ++v)
      if (behind[v]) at_rest_.back()[v] = 1.0;
  }
}

std::vector<double> Crossings::depths(const std::vector<Vec3>& vertices, int opening) const {
  TriangleMesh now = welded_;
  for (size_t w = 0; w < now.vertices.size(); ++w)
    if (source_[w] >= 0) now.vertices[w] = vertices[static_cast<size_t>(source_[w])];
  const std::vector<Vec3> normals = vertex_normals(now);
  std::optional<spatial::SurfaceQuery> whole;
  std::vector<double> depth(now.vertices.size(), 0.0);
  for (int which = 0; which < 2; ++which) {
    const auto side = static_cast<uint8_t>(2 * opening + which), other = static_cast<uint8_t>(side ^ 1);
    const SideSurface facing(now, sides_, other);
    if (facing.mesh.triangles.empty()) continue;
    const spatial::SurfaceQuery query(facing.mesh);
    for (size_t v = 0; v < depth.size(); ++v) {
      if (sides_[v] != side || (at_rest_.size() > static_cast<size_t>(opening) &&
                                !at_rest_[static_cast<size_t>(opening)].empty() &&
                                at_rest_[static_cast<size_t>(opening)][v] >= 1.0))
        continue;
      const spatial::ClosestPoint hit = query.closest(now.vertices[v], deepest);
      if (!hit.found() || hit.signed_distance >= 0.0 || hit.pseudonormal.dot(normals[v]) > 0.0 ||
          facing.is_border(hit.surface))
        continue;
      // Beside an edge of the other side, not behind it.
      if ((now.vertices[v] - hit.position).dot(hit.pseudonormal) > -0.8 * hit.distance) continue;
      // What lies behind a lip but outside of its flesh, as the far side of the mouth, has skin in between.
      if (!whole) whole.emplace(now);
      constexpr double skip = 2e-5;
      if (hit.distance > 4 * skip &&
          whole->first_hit(now.vertices[v], hit.position - now.vertices[v], hit.distance - skip, skip))
        continue;
      depth[v] = hit.distance;
    }
  }
  return depth;
}

Crossings::Worst Crossings::find(const std::vector<Vec3>& vertices, int opening, double tolerance) const {
  Worst worst;
  const std::vector<double> now = depths(vertices, opening);
  for (size_t v = 0; v < now.size(); ++v) {
    const double more = now[v] - at_rest_[static_cast<size_t>(opening)][v];
    if (more > tolerance) ++worst.count;
    if (more <= worst.depth) continue;
    worst.depth = more;
    worst.place = vertices[static_cast<size_t>(source_[v])];
  }
  return worst;
}

}  // namespace fascia::testing
