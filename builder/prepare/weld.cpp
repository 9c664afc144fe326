#include <numeric>

#include "builder/prepare/parts.h"
#include "geometry/connectivity.h"

namespace fascia::prepare {

namespace {

/// Meshes that may be welded to each other: the primitives of one glTF mesh, all objects of other files.
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

}  // namespace

WeldedScene weld_scene(const formats::Scene& scene, const Mat4& input_to_metres) {
  WeldedScene welded;
  TriangleMesh raw;
  std::vector<std::vector<int>> raw_of(scene.meshes.size());
  std::vector<int> triangle_mesh;
  std::map<int, std::vector<int>> groups;
  for (size_t m = 0; m < scene.meshes.size(); ++m) {
    const formats::SceneMesh& mesh = scene.meshes[m];
    const int base = raw.vertex_count();
    for (const Vec3& p : mesh.positions) {
      groups[weld_group(mesh)].push_back(raw.vertex_count());
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
  for (const auto& [group, members] : groups)
    merge_open_vertices(raw, open, members, tolerance, representative);

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
    if (corners[0] == corners[1] || corners[1] == corners[2] || corners[2] == corners[0]) continue;
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
