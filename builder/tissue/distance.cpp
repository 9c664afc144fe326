#include "builder/tissue/distance.h"

#include <algorithm>
#include <queue>
#include <tuple>

namespace fascia::tissue {

std::vector<std::vector<int>> vertex_neighbours(const TriangleMesh& mesh) {
  std::vector<std::vector<int>> neighbours(mesh.vertices.size());
  for (const fascia::Triangle& t : mesh.triangles)
    for (size_t k = 0; k < 3; ++k) {
      neighbours[static_cast<size_t>(t[k])].push_back(t[(k + 1) % 3]);
      neighbours[static_cast<size_t>(t[k])].push_back(t[(k + 2) % 3]);
    }
  for (auto& list : neighbours) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }
  return neighbours;
}

EdgeDistances edge_distances(const TriangleMesh& mesh, const std::vector<DistanceSeed>& seeds, double range,
                             const std::vector<bool>& allowed) {
  const auto neighbours = vertex_neighbours(mesh);
  EdgeDistances result;
  result.distance.assign(mesh.vertices.size(), std::numeric_limits<double>::infinity());
  result.seed.assign(mesh.vertices.size(), -1);
  using Entry = std::tuple<double, int, int>;  // distance, seed, vertex
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  for (size_t s = 0; s < seeds.size(); ++s) open.emplace(seeds[s].distance, static_cast<int>(s), seeds[s].vertex);
  while (!open.empty()) {
    const auto [distance, seed, vertex] = open.top();
    open.pop();
    const auto v = static_cast<size_t>(vertex);
    if (result.seed[v] >= 0 || distance > range) continue;
    result.distance[v] = distance;
    result.seed[v] = seed;
    for (const int next : neighbours[v]) {
      const auto n = static_cast<size_t>(next);
      if (result.seed[n] >= 0 || (!allowed.empty() && !allowed[n])) continue;
      open.emplace(distance + (mesh.vertices[n] - mesh.vertices[v]).norm(), seed, next);
    }
  }
  return result;
}

}  // namespace fascia::tissue
