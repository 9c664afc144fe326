#include "builder/tissue/distance.h"

#include <algorithm>
#include <cmath>
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

namespace {

/// Settles vertices from the seeds outward (Dijkstra 1959). `offer(vertex, distance, result, is_open, put)`
/// calls put(next, reached) for what a settled vertex leads to.
template <class Offer>
EdgeDistances spread(const TriangleMesh& mesh, const std::vector<DistanceSeed>& seeds, double range,
                     const std::vector<bool>& allowed, Offer&& offer) {
  EdgeDistances result;
  result.distance.assign(mesh.vertices.size(), std::numeric_limits<double>::infinity());
  result.seed.assign(mesh.vertices.size(), -1);
  using Entry = std::tuple<double, int, int>;  // distance, seed, vertex
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> open;
  for (size_t s = 0; s < seeds.size(); ++s)
    open.emplace(seeds[s].distance, static_cast<int>(s), seeds[s].vertex);
  while (!open.empty()) {
    const auto [distance, seed, vertex] = open.top();
    open.pop();
    const auto v = static_cast<size_t>(vertex);
    if (result.seed[v] >= 0 || distance > range) continue;
    result.distance[v] = distance;
    result.seed[v] = seed;
    const auto is_open = [&](size_t n) { return result.seed[n] < 0 && (allowed.empty() || allowed[n]); };
    const auto put = [&open, from = seed](size_t next, double reached) {
      open.emplace(reached, from, static_cast<int>(next));
    };
    offer(v, distance, result, is_open, put);
  }
  return result;
}

/// Where a straight front that reaches `a` and `b` after so long reaches `c`; infinity when it comes in
/// beside the edge between them.
double across(const Vec3& a, double to_a, const Vec3& b, double to_b, const Vec3& c) {
  constexpr double never = std::numeric_limits<double>::infinity();
  const Vec3 edge = b - a, arm = c - a;
  const double length = edge.norm();
  if (!(length > 0.0)) return never;
  const double along = arm.dot(edge) / length,
               height = std::sqrt(std::max(0.0, arm.squaredNorm() - along * along));
  const double cosine = (to_b - to_a) / length, sine = std::sqrt(1.0 - std::min(1.0, cosine * cosine));
  if (!(sine > 1e-6)) return never;
  const double foot = along - height * cosine / sine;  // where the way to c crosses the edge
  return foot >= 0.0 && foot <= length ? to_a + along * cosine + height * sine : never;
}

}  // namespace

EdgeDistances edge_distances(const TriangleMesh& mesh, const std::vector<DistanceSeed>& seeds, double range,
                             const std::vector<bool>& allowed) {
  const auto neighbours = vertex_neighbours(mesh);
  return spread(mesh, seeds, range, allowed,
                [&](size_t v, double distance, const EdgeDistances&, const auto& is_open, const auto& put) {
                  for (const int next : neighbours[v])
                    if (const auto n = static_cast<size_t>(next); is_open(n))
                      put(n, distance + (mesh.vertices[n] - mesh.vertices[v]).norm());
                });
}

EdgeDistances surface_distances(const TriangleMesh& mesh, const std::vector<DistanceSeed>& seeds,
                                double range, const std::vector<bool>& allowed) {
  std::vector<std::vector<int>> around(mesh.vertices.size());
  for (size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const int v : mesh.triangles[t])
      around[static_cast<size_t>(v)].push_back(static_cast<int>(t));
  return spread(
      mesh, seeds, range, allowed,
      [&](size_t v, double distance, const EdgeDistances& known, const auto& is_open, const auto& put) {
        for (const int triangle : around[v])
          for (const int next : mesh.triangles[static_cast<size_t>(triangle)]) {
            const auto n = static_cast<size_t>(next);
            if (!is_open(n)) continue;
            double reached = distance + (mesh.vertices[n] - mesh.vertices[v]).norm();
            for (const int other : mesh.triangles[static_cast<size_t>(triangle)]) {
              const auto o = static_cast<size_t>(other);
              if (o == v || o == n || known.seed[o] < 0) continue;
              reached =
                  std::min(reached, std::max(distance, across(mesh.vertices[v], distance, mesh.vertices[o],
                                                              known.distance[o], mesh.vertices[n])));
            }
            put(n, reached);
          }
      });
}

}  // namespace fascia::tissue
