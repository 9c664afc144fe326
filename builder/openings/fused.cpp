#include "builder/openings/fused.h"

#include <map>
#include <queue>

namespace fascia::openings {

namespace {

/// Length of the shortest way over the mesh's edges from one place on it to another; `limit` when longer.
double way_between(const TriangleMesh& mesh, const Connectivity& links, const spatial::RayHit& from,
                   const spatial::RayHit& to, double limit) {
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

}  // namespace

bool is_fused(const TriangleMesh& mesh, const Connectivity& links, const spatial::SurfaceQuery& surface,
              const MeetingLine& line) {
  const double width = 2.0 * line.half_width, off = 0.1 * width, limit = 0.6 * width;
  int closed = 0, asked = 0;
  bool is_middle_open = false;
  for (const double along : {-0.3, -0.15, 0.0, 0.15, 0.3}) {
    const auto above = surface.first_hit(line.place(along, off, width), -line.axes.col(2), 2.0 * width),
               below = surface.first_hit(line.place(along, -off, width), -line.axes.col(2), 2.0 * width);
    if (!above || !below) continue;
    ++asked;
    // Lips and closed lids bulge before their corners; behind them lies what shows through an opening.
    const double front = std::min((above->position - line.origin).dot(line.axes.col(2)),
                                  (below->position - line.origin).dot(line.axes.col(2)));
    if (front < -0.05 * width) continue;
    const bool is_closed = way_between(mesh, links, *above, *below, limit) < 0.55 * width;
    closed += is_closed ? 1 : 0;
    // A slit narrower than the line, as where the corners were placed too far out: near its ends the way
    // around them is short.
    is_middle_open = is_middle_open || (along == 0.0 && !is_closed);
  }
  return asked > 0 && 2 * closed > asked && !is_middle_open;
}

}  // namespace fascia::openings
