#include "builder/spatial/way_between.h"

#include <map>
#include <queue>

namespace fascia::spatial {

double way_between(const TriangleMesh& mesh, const Connectivity& links, const RayHit& from, const RayHit& to,
                   double limit) {
  std::map<int, double> known;
  using Entry = std::pair<double, int>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  const auto reach = [&](int v, double distance) {
    const auto [at, is_new] = known.try_emplace(v, distance);
    if (!is_new && !(distance < at->second)) return;
    at->second = distance;
    if (distance < limit) queue.emplace(distance, v);
  };
  if (from.surface.triangle == to.surface.triangle) return (from.position - to.position).norm();
  for (const int v : mesh.triangles[static_cast<size_t>(from.surface.triangle)])
    reach(v, (mesh.vertices[static_cast<size_t>(v)] - from.position).norm());
  double best = limit;
  const Triangle& goal = mesh.triangles[static_cast<size_t>(to.surface.triangle)];
  while (!queue.empty()) {
    const auto [distance, v] = queue.top();
    queue.pop();
    if (distance >= best) break;
    if (distance > known[v]) continue;
    for (const int corner : goal)
      if (corner == v)
        best = std::min(best, distance + (mesh.vertices[static_cast<size_t>(v)] - to.position).norm());
    for (int i = links.vertex_offsets[static_cast<size_t>(v)];
         i < links.vertex_offsets[static_cast<size_t>(v) + 1]; ++i)
      for (const int w : mesh.triangles[static_cast<size_t>(links.vertex_triangles[static_cast<size_t>(i)])])
        if (w != v)
          reach(w,
                distance +
                    (mesh.vertices[static_cast<size_t>(w)] - mesh.vertices[static_cast<size_t>(v)]).norm());
  }
  return best;
}

}  // namespace fascia::spatial
