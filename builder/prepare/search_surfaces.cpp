#include <algorithm>

#include "builder/prepare/part_names.h"
#include "builder/prepare/prepare.h"

namespace fascia::prepare {

namespace {

/// What lies before a face or about it and is none of it.
bool may_hide_a_face(const formats::SceneMesh& mesh) {
  const NamedPart named = part_by_name(mesh.name + " " + mesh.material);
  if (!named.part) return false;
  switch (*named.part) {
    case Part::hair:
    case Part::clothes:
    case Part::glasses:
    case Part::lashes:
    case Part::brows:
    case Part::eye_surround:
      return true;
    default:
      return false;
  }
}

TriangleMesh joined(const std::vector<const formats::SceneMesh*>& meshes) {
  TriangleMesh all;
  for (const formats::SceneMesh* mesh : meshes) {
    const int base = all.vertex_count();
    all.vertices.insert(all.vertices.end(), mesh->positions.begin(), mesh->positions.end());
    for (const Triangle& t : mesh->triangles)
      all.triangles.push_back({t[0] + base, t[1] + base, t[2] + base});
  }
  return all;
}

double area_of(const formats::SceneMesh& mesh) {
  const TriangleMesh triangles{mesh.positions, mesh.triangles};
  double area = 0.0;
  for (int t = 0; t < triangles.triangle_count(); ++t)
    area += triangle_area(triangles, t);
  return area;
}

}  // namespace

std::vector<TriangleMesh> search_surfaces(const formats::Scene& scene, const std::string& only) {
  if (!only.empty()) return {joined_meshes(scene, only)};
  std::vector<const formats::SceneMesh*> all, bare;
  for (const formats::SceneMesh& mesh : scene.meshes) {
    if (mesh.triangles.empty()) continue;
    all.push_back(&mesh);
    if (!may_hide_a_face(mesh)) bare.push_back(&mesh);
  }
  std::vector<TriangleMesh> surfaces;
  if (!bare.empty() && bare.size() < all.size()) surfaces.push_back(joined(bare));
  surfaces.push_back(joined(all));
  // A face is no speck of a file; what its meshes are called does not matter here.
  const size_t most = 8, fewest_triangles = 100;
  std::vector<const formats::SceneMesh*> large = all;
  std::erase_if(large, [&](const auto* mesh) { return mesh->triangles.size() < fewest_triangles; });
  std::vector<std::pair<double, const formats::SceneMesh*>> by_area;
  for (const formats::SceneMesh* mesh : large)
    by_area.emplace_back(area_of(*mesh), mesh);
  std::stable_sort(by_area.begin(), by_area.end(),
                   [](const auto& a, const auto& b) { return a.first > b.first; });
  if (all.size() > 1)
    for (size_t m = 0; m < std::min(most, by_area.size()); ++m)
      surfaces.push_back(joined({by_area[m].second}));
  return surfaces;
}

}  // namespace fascia::prepare
