#include "builder/prepare/computing_skin.h"

#include <algorithm>

#include "geometry/connectivity.h"
#include "geometry/flaps.h"
#include "geometry/slivers.h"

namespace fascia::prepare {

namespace {

/// "3 triangles of the skin, the first at vertex 812 of 'head',": of `places`, vertices of the surface.
std::string told(const formats::Scene& scene, const WeldedScene& welded, std::vector<int> places,
                 const std::string& one, const std::string& many) {
  std::sort(places.begin(), places.end());
  const std::string count = places.size() == 1 ? "1 " + one : std::to_string(places.size()) + " " + many;
  for (size_t m = 0; m < welded.vertex_map.size(); ++m)
    for (size_t v = 0; v < welded.vertex_map[m].size(); ++v)
      if (std::binary_search(places.begin(), places.end(), welded.vertex_map[m][v]))
        return count + ", the first at vertex " + std::to_string(v) + " of '" + scene.meshes[m].name + "',";
  return count;
}

double height_of(const TriangleMesh& mesh, size_t triangle) {
  const Triangle& t = mesh.triangles[triangle];
  const auto corner = [&](size_t k) -> const Vec3& { return mesh.vertices[static_cast<size_t>(t[k])]; };
  return triangle_height(corner(0), corner(1), corner(2));
}

/// A corner of each of `triangles`.
std::vector<int> corners_of(const TriangleMesh& mesh, const std::vector<size_t>& triangles) {
  std::vector<int> corners;
  for (const size_t t : triangles)
    corners.push_back(mesh.triangles[t][0]);
  return corners;
}

}  // namespace

ComputingSkin computing_skin(const formats::Scene& scene, const WeldedScene& welded,
                             const std::vector<bool>& is_skin, std::vector<std::string>& warnings) {
  constexpr double lowest = 2e-6;  // metres: what single precision leaves of a height in a whole body
  ComputingSkin skin;
  std::vector<int> mended, bare, last;
  const TriangleMesh whole = with_hanging_patches_joined(submesh(welded.surface, is_skin, &skin.vertex));
  const std::vector<bool> stays = without_flaps(whole);
  std::vector<size_t> fins, flat;
  for (size_t t = 0, own = 0; t < is_skin.size(); ++t) {
    if (!is_skin[t]) continue;
    if (!stays[own++])
      fins.push_back(t);
    else if (height_of(welded.surface, t) < lowest)
      flat.push_back(t);
  }
  const TriangleMesh repaired = without_slivers(submesh(whole, stays, &bare), lowest, &mended);
  // Where slivers were collapsed, two triangles may have come to lie back to back.
  skin.mesh = submesh(repaired, without_flaps(repaired), &last);
  for (int& v : skin.vertex)
    for (const std::vector<int>* step : {&bare, &mended, &last})
      if (v >= 0) v = (*step)[static_cast<size_t>(v)];
  if (!fins.empty())
    warnings.push_back(told(scene, welded, corners_of(welded.surface, fins), "triangle of the skin",
                            "triangles of the skin") +
                       " stand on edges that two others share: nothing is computed with them");
  if (!flat.empty())
    warnings.push_back(told(scene, welded, corners_of(welded.surface, flat), "triangle of the skin",
                            "triangles of the skin") +
                       " are lower than two micrometres: they were taken as edges");
  return skin;
}

void warn_of_collapsed(const formats::Scene& scene, const WeldedScene& welded,
                       const std::vector<Part>& vertex_part, std::vector<std::string>& warnings) {
  std::vector<std::pair<int, int>> on_skin;
  for (const auto& [mesh, vertex] : welded.collapsed) {
    const int at = welded.vertex_map[static_cast<size_t>(mesh)][static_cast<size_t>(vertex)];
    if (vertex_part[static_cast<size_t>(at)] == Part::skin) on_skin.emplace_back(mesh, vertex);
  }
  if (on_skin.empty()) return;
  const auto [mesh, vertex] = on_skin.front();
  const size_t count = on_skin.size();
  warnings.push_back((count == 1 ? "1 triangle" : std::to_string(count) + " triangles") +
                     ", the first at vertex " + std::to_string(vertex) + " of '" +
                     scene.meshes[static_cast<size_t>(mesh)].name +
                     "', have two corners in one place: they were left out");
}

void warn_of_specks(const formats::Scene& scene, const WeldedScene& welded, const Parts& parts,
                    std::vector<std::string>& warnings) {
  constexpr double largest = 1.5e-5;  // square metres: a tooth's crown, or a lash card, has more
  std::vector<double> area(static_cast<size_t>(welded.component_count), 0.0);
  std::vector<int> corner(area.size(), -1), specks;
  for (size_t t = 0; t < welded.component.size(); ++t) {
    const auto c = static_cast<size_t>(welded.component[t]);
    area[c] += triangle_area(welded.surface, static_cast<int>(t));
    if (corner[c] < 0) corner[c] = welded.surface.triangles[t][0];
  }
  for (size_t c = 0; c < area.size(); ++c)
    if (parts.component_parts[c] == Part::other && area[c] < largest) specks.push_back(corner[c]);
  if (!specks.empty())
    warnings.push_back(
        told(scene, welded, specks, "piece", "pieces") +
        " are too small to be a part of the head: they move with what is near them, or not at all");
}

}  // namespace fascia::prepare
