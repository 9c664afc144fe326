#include "geometry/connectivity.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <numeric>
#include <unordered_map>

#include "geometry/disjoint_sets.h"

namespace fascia {

// By ends, then by triangle: buckets by the lower end, each short enough to sort by insertion.
std::vector<HalfEdge> sorted_half_edges(const std::vector<Triangle>& triangles, size_t vertex_count) {
  std::vector<int> offsets(vertex_count + 1, 0);
  for (const Triangle& triangle : triangles)
    for (int e = 0; e < 3; ++e)
      ++offsets[std::min(triangle[e], triangle[(e + 1) % 3]) + 1];
  std::partial_sum(offsets.begin(), offsets.end(), offsets.begin());
  std::vector<HalfEdge> edges(triangles.size() * 3);
  std::vector<int> filled(offsets.begin(), offsets.end() - 1);
  for (int t = 0; t < static_cast<int>(triangles.size()); ++t)
    for (int e = 0; e < 3; ++e) {
      const int a = triangles[t][e], b = triangles[t][(e + 1) % 3];
      edges[filled[std::min(a, b)]++] = {std::min(a, b), std::max(a, b), t, e, a < b};
    }
  const auto by_high = [](const HalfEdge& p, const HalfEdge& q) { return p.high < q.high; };
  for (size_t v = 0; v + 1 < offsets.size(); ++v) {
    const auto first = edges.begin() + offsets[v], last = edges.begin() + offsets[v + 1];
    // A hub of a fan has as many edges as the mesh has triangles.
    if (last - first > 32) {
      std::stable_sort(first, last, by_high);
      continue;
    }
    for (auto next = first; next != last; ++next)
      std::rotate(std::upper_bound(first, next, *next, by_high), next, next + 1);
  }
  return edges;
}

Connectivity connectivity(const TriangleMesh& mesh) {
  Connectivity links;
  links.neighbours.assign(mesh.triangles.size(), {-1, -1, -1});
  const std::vector<HalfEdge> edges = sorted_half_edges(mesh.triangles, mesh.vertices.size());
  for (size_t i = 0; i < edges.size();) {
    size_t j = i + 1;
    while (j < edges.size() && edges[j].low == edges[i].low && edges[j].high == edges[i].high)
      ++j;
    if (j - i == 2 && edges[i].forward != edges[i + 1].forward) {
      links.neighbours[edges[i].triangle][edges[i].edge] = edges[i + 1].triangle;
      links.neighbours[edges[i + 1].triangle][edges[i + 1].edge] = edges[i].triangle;
    } else if (j - i > 1) {
      ++links.irregular_edges;
    }
    i = j;
  }
  links.vertex_offsets.assign(mesh.vertices.size() + 1, 0);
  for (const Triangle& triangle : mesh.triangles)
    for (int v : triangle)
      ++links.vertex_offsets[v + 1];
  std::partial_sum(links.vertex_offsets.begin(), links.vertex_offsets.end(), links.vertex_offsets.begin());
  links.vertex_triangles.resize(mesh.triangles.size() * 3);
  std::vector<int> cursor(links.vertex_offsets.begin(), links.vertex_offsets.end() - 1);
  for (int t = 0; t < mesh.triangle_count(); ++t)
    for (int v : mesh.triangles[t])
      links.vertex_triangles[cursor[v]++] = t;
  return links;
}

std::vector<std::vector<int>> boundary_loops(const TriangleMesh& mesh, const Connectivity& links) {
  std::multimap<int, int> next;
  for (int t = 0; t < mesh.triangle_count(); ++t)
    for (int e = 0; e < 3; ++e)
      if (links.neighbours[t][e] < 0) next.emplace(mesh.triangles[t][e], mesh.triangles[t][(e + 1) % 3]);
  std::vector<std::vector<int>> loops;
  while (!next.empty()) {
    std::vector<int> loop;
    const int start = next.begin()->first;
    int at = start;
    for (auto step = next.find(at); step != next.end(); step = next.find(at)) {
      loop.push_back(at);
      at = step->second;
      next.erase(step);
      if (at == start) break;
    }
    loops.push_back(std::move(loop));
  }
  std::stable_sort(loops.begin(), loops.end(),
                   [](const auto& a, const auto& b) { return a.size() > b.size(); });
  return loops;
}

std::vector<int> components(const TriangleMesh& mesh, int* count) {
  DisjointSets sets(mesh.vertices.size());
  for (const Triangle& triangle : mesh.triangles)
    for (int e = 1; e < 3; ++e)
      sets.join(triangle[0], triangle[e]);
  std::unordered_map<int, int> number;
  std::vector<int> component(mesh.triangles.size());
  for (int t = 0; t < mesh.triangle_count(); ++t) {
    const int root = sets.of(mesh.triangles[t][0]);
    component[t] = number.try_emplace(root, static_cast<int>(number.size())).first->second;
  }
  if (count) *count = static_cast<int>(number.size());
  return component;
}

TriangleMesh weld(const TriangleMesh& mesh, double tolerance, std::vector<int>* vertex_map) {
  // A hash grid of cells two tolerances wide: a partner lies in one of the 27 cells around.
  const double cell = std::max(2.0 * tolerance, 1e-12);
  const auto key = [](int64_t x, int64_t y, int64_t z) {
    return static_cast<uint64_t>(x) * 73856093U ^ static_cast<uint64_t>(y) * 19349663U ^
           static_cast<uint64_t>(z) * 83492791U;
  };
  std::unordered_multimap<uint64_t, int> grid;
  grid.reserve(mesh.vertices.size());
  TriangleMesh welded;
  std::vector<int> map(mesh.vertices.size());
  for (size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Vec3& p = mesh.vertices[i];
    const std::array<int64_t, 3> at = {std::llround(std::floor(p[0] / cell)),
                                       std::llround(std::floor(p[1] / cell)),
                                       std::llround(std::floor(p[2] / cell))};
    int found = -1;
    for (int64_t dx = -1; dx <= 1 && found < 0; ++dx)
      for (int64_t dy = -1; dy <= 1 && found < 0; ++dy)
        for (int64_t dz = -1; dz <= 1 && found < 0; ++dz) {
          const auto range = grid.equal_range(key(at[0] + dx, at[1] + dy, at[2] + dz));
          for (auto it = range.first; it != range.second; ++it)
            if ((welded.vertices[it->second] - p).norm() <= tolerance) {
              found = it->second;
              break;
            }
        }
    if (found < 0) {
      found = welded.vertex_count();
      welded.vertices.push_back(p);
      grid.emplace(key(at[0], at[1], at[2]), found);
    }
    map[i] = found;
  }
  for (const Triangle& t : mesh.triangles) {
    const Triangle corners = {map[t[0]], map[t[1]], map[t[2]]};
    if (corners[0] != corners[1] && corners[1] != corners[2] && corners[2] != corners[0])
      welded.triangles.push_back(corners);
  }
  if (vertex_map) *vertex_map = std::move(map);
  return welded;
}

TriangleMesh submesh(const TriangleMesh& mesh, const std::vector<bool>& keep, std::vector<int>* vertex_map) {
  TriangleMesh part;
  std::vector<int> map(mesh.vertices.size(), -1);
  for (int t = 0; t < mesh.triangle_count(); ++t) {
    if (!keep[t]) continue;
    Triangle corners;
    for (int e = 0; e < 3; ++e) {
      int& target = map[mesh.triangles[t][e]];
      if (target < 0) {
        target = part.vertex_count();
        part.vertices.push_back(mesh.vertices[mesh.triangles[t][e]]);
      }
      corners[e] = target;
    }
    part.triangles.push_back(corners);
  }
  if (vertex_map) *vertex_map = std::move(map);
  return part;
}

}  // namespace fascia
