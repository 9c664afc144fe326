#include <algorithm>
#include <map>
#include <numeric>
#include <set>

#include "builder/prepare/part_names.h"
#include "builder/prepare/parts.h"
#include "geometry/connectivity.h"

namespace fascia::prepare {

namespace {

/// The primitives of one glTF mesh, or all objects of another file: welded to each other in any case.
int weld_group(const formats::SceneMesh& mesh) {
  return mesh.mesh >= 0 ? mesh.mesh * 4096 + mesh.node : -1;
}

std::vector<bool> on_open_edge(const TriangleMesh& mesh) {
  const Connectivity links = connectivity(mesh);
  std::vector<bool> open(mesh.vertices.size(), false);
  for (int t = 0; t < mesh.triangle_count(); ++t)
    for (size_t e = 0; e < 3; ++e)
      if (links.neighbours[static_cast<size_t>(t)][e] < 0) {
        open[static_cast<size_t>(mesh.triangles[static_cast<size_t>(t)][e])] = true;
        open[static_cast<size_t>(mesh.triangles[static_cast<size_t>(t)][(e + 1) % 3])] = true;
      }
  return open;
}

/// Map from the vertices of `raw` to merged ones, of vertices `[begin, end)` that lie on open edges.
void merge_open_vertices(const TriangleMesh& raw, const std::vector<bool>& open,
                         const std::vector<int>& members, double tolerance,
                         std::vector<int>& representative) {
  TriangleMesh rim;
  std::vector<int> source;
  for (int v : members)
    if (open[static_cast<size_t>(v)]) {
      rim.vertices.push_back(raw.vertices[static_cast<size_t>(v)]);
      source.push_back(v);
    }
  std::vector<int> map;
  const TriangleMesh merged = weld(rim, tolerance, &map);
  std::vector<int> first(merged.vertices.size(), -1);
  for (size_t i = 0; i < map.size(); ++i) {
    int& leader = first[static_cast<size_t>(map[i])];
    if (leader < 0) leader = source[i];
    representative[static_cast<size_t>(source[i])] = leader;
  }
}

/// How many edges that are open in their own mesh lie in one place with an open one of another mesh, by the
/// two meshes' numbers, the lower first. Meshes that `may_join` leaves out are not looked at.
std::map<std::pair<int, int>, int> shared_rims(const TriangleMesh& raw, const std::vector<int>& triangle_mesh,
                                               const std::vector<bool>& may_join, double tolerance) {
  std::vector<int> place;
  weld(raw, tolerance, &place);
  const Connectivity links = connectivity(raw);
  std::map<std::pair<int, int>, std::set<int>> meshes_at;
  for (int t = 0; t < raw.triangle_count(); ++t)
    for (size_t e = 0; e < 3; ++e) {
      const int mesh = triangle_mesh[static_cast<size_t>(t)];
      if (links.neighbours[static_cast<size_t>(t)][e] >= 0 || !may_join[static_cast<size_t>(mesh)]) continue;
      const Triangle& corners = raw.triangles[static_cast<size_t>(t)];
      const int a = place[static_cast<size_t>(corners[e])],
                b = place[static_cast<size_t>(corners[(e + 1) % 3])];
      if (a != b) meshes_at[std::minmax(a, b)].insert(mesh);
    }
  std::map<std::pair<int, int>, int> edges;
  for (const auto& [edge, meshes] : meshes_at)
    for (const int m : meshes)
      for (const int other : meshes)
        if (m < other) ++edges[{m, other}];
  return edges;
}

/// Of each mesh the group within which it is welded: its own, and those along whose rims its rim runs, as
/// where a head comes in pieces. What is called something else than skin keeps to itself.
std::vector<int> weld_groups(const formats::Scene& scene, const TriangleMesh& raw,
                             const std::vector<int>& triangle_mesh, double tolerance) {
  constexpr int fewest = 6;  // edges: what touches in a few is not cut from one piece
  std::vector<int> group;
  std::vector<bool> may_join;
  for (const formats::SceneMesh& mesh : scene.meshes) {
    group.push_back(weld_group(mesh));
    may_join.push_back(part_by_name(mesh.name + " " + mesh.material).part.value_or(Part::skin) == Part::skin);
  }
  const bool are_one = std::all_of(group.begin(), group.end(), [&](int g) { return g == group.front(); });
  if (are_one) return group;
  for (const auto& [meshes, edges] : shared_rims(raw, triangle_mesh, may_join, tolerance))
    if (edges >= fewest)
      std::replace(group.begin(), group.end(), int{group[static_cast<size_t>(meshes.second)]},
                   int{group[static_cast<size_t>(meshes.first)]});
  return group;
}

/// A vertex that no triangle uses, as of a copy that was left out, stands for the used one in its place.
void follow_used_vertices(const TriangleMesh& raw, double tolerance, std::vector<int>& representative) {
  std::vector<bool> is_used(raw.vertices.size(), false);
  for (const Triangle& t : raw.triangles)
    for (const int v : t)
      is_used[static_cast<size_t>(v)] = true;
  if (std::find(is_used.begin(), is_used.end(), false) == is_used.end()) return;
  std::vector<int> place;
  const TriangleMesh merged = weld({raw.vertices, {}}, tolerance, &place);
  std::vector<int> used(merged.vertices.size(), -1);
  for (size_t v = is_used.size(); v-- > 0;)
    if (is_used[v]) used[static_cast<size_t>(place[v])] = representative[v];
  for (size_t v = 0; v < is_used.size(); ++v)
    if (const int other = used[static_cast<size_t>(place[v])]; !is_used[v] && other >= 0)
      representative[v] = other;
}

}  // namespace

WeldedScene weld_scene(const formats::Scene& scene, const Mat4& input_to_metres) {
  WeldedScene welded;
  TriangleMesh raw;
  std::vector<std::vector<int>> raw_of(scene.meshes.size());
  std::vector<int> triangle_mesh;
  for (size_t m = 0; m < scene.meshes.size(); ++m) {
    const formats::SceneMesh& mesh = scene.meshes[m];
    const int base = raw.vertex_count();
    for (const Vec3& p : mesh.positions) {
      raw_of[m].push_back(raw.vertex_count());
      raw.vertices.push_back(transform_point(input_to_metres, p));
    }
    for (const Triangle& t : mesh.triangles) {
      raw.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
      triangle_mesh.push_back(static_cast<int>(m));
    }
  }
  const std::vector<bool> open = on_open_edge(raw);
  std::vector<int> representative(raw.vertices.size());
  std::iota(representative.begin(), representative.end(), 0);
  const double tolerance = 1e-6;  // metres: seams repeat their positions to single precision
  const std::vector<int> group_of = weld_groups(scene, raw, triangle_mesh, tolerance);
  std::map<int, std::vector<int>> groups;
  for (size_t m = 0; m < raw_of.size(); ++m) {
    std::vector<int>& members = groups[group_of[m]];
    members.insert(members.end(), raw_of[m].begin(), raw_of[m].end());
  }
  for (const auto& [group, members] : groups)
    merge_open_vertices(raw, open, members, tolerance, representative);
  follow_used_vertices(raw, tolerance, representative);

  std::vector<int> compact(raw.vertices.size(), -1);
  for (size_t v = 0; v < raw.vertices.size(); ++v) {
    if (representative[v] != static_cast<int>(v)) continue;
    compact[v] = welded.surface.vertex_count();
    welded.surface.vertices.push_back(raw.vertices[v]);
  }
  const auto target = [&](int v) {
    return compact[static_cast<size_t>(representative[static_cast<size_t>(v)])];
  };
  for (size_t t = 0; t < raw.triangles.size(); ++t) {
    const Triangle corners = {target(raw.triangles[t][0]), target(raw.triangles[t][1]),
                              target(raw.triangles[t][2])};
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) {
      const int mesh = triangle_mesh[t];
      welded.collapsed.push_back({mesh, raw.triangles[t][0] - raw_of[static_cast<size_t>(mesh)].front()});
      continue;
    }
    welded.surface.triangles.push_back(corners);
    welded.triangle_mesh.push_back(triangle_mesh[t]);
  }
  for (std::vector<int>& map : raw_of) {
    for (int& v : map)
      v = target(v);
    welded.vertex_map.push_back(std::move(map));
  }
  welded.component = components(welded.surface, &welded.component_count);
  return welded;
}

}  // namespace fascia::prepare
