#include "builder/smas/trim.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>

#include "geometry/connectivity.h"

namespace fascia::smas {

void keep_triangles(const std::vector<bool>& keep, TriangleMesh* mesh, std::vector<Vec3>* normals,
                    std::vector<double>* sizes, std::vector<double>* field) {
  std::vector<int> map;
  TriangleMesh part = submesh(*mesh, keep, &map);
  std::vector<Vec3> kept_normals(part.vertices.size());
  std::vector<double> kept_sizes(part.vertices.size()), kept_field(part.vertices.size());
  for (size_t v = 0; v < map.size(); ++v) {
    if (map[v] < 0) continue;
    kept_normals[map[v]] = (*normals)[v];
    kept_sizes[map[v]] = (*sizes)[v];
    kept_field[map[v]] = (*field)[v];
  }
  *mesh = std::move(part);
  *normals = std::move(kept_normals);
  *sizes = std::move(kept_sizes);
  *field = std::move(kept_field);
}

void trim(double snap, TriangleMesh* mesh, std::vector<Vec3>* normals, std::vector<double>* sizes,
          std::vector<double>* field) {
  std::vector<double>& f = *field;
  // Snap: each vertex close to the line moves to it along the edge on which the line is nearest.
  std::vector<double> nearest(mesh->vertices.size(), snap);
  std::vector<int> towards(mesh->vertices.size(), -1);
  const auto crosses = [&](int a, int b) { return (f[a] > 0.0 && f[b] < 0.0) || (f[a] < 0.0 && f[b] > 0.0); };
  for (const Triangle& t : mesh->triangles)
    for (int e = 0; e < 3; ++e)
      for (const auto& [a, b] : {std::pair(t[e], t[(e + 1) % 3]), std::pair(t[(e + 1) % 3], t[e])}) {
        if (!crosses(a, b)) continue;
        const double part = f[a] / (f[a] - f[b]);
        if (part < nearest[a]) nearest[a] = part, towards[a] = b;
      }
  const std::vector<Vec3> before = mesh->vertices;
  for (size_t v = 0; v < towards.size(); ++v) {
    if (towards[v] < 0) continue;
    mesh->vertices[v] += nearest[v] * (before[towards[v]] - before[v]);
    f[v] = 0.0;
  }
  // Cut what still crosses.
  std::map<std::pair<int, int>, int> cuts;
  const auto cut = [&](int a, int b) {
    const auto [at, fresh] = cuts.try_emplace({std::min(a, b), std::max(a, b)}, mesh->vertex_count());
    if (fresh) {
      const double part = f[a] / (f[a] - f[b]);
      mesh->vertices.push_back(mesh->vertices[a] + part * (mesh->vertices[b] - mesh->vertices[a]));
      normals->push_back(((1.0 - part) * (*normals)[a] + part * (*normals)[b]).normalized());
      sizes->push_back((1.0 - part) * (*sizes)[a] + part * (*sizes)[b]);
      f.push_back(0.0);
    }
    return at->second;
  };
  std::vector<Triangle> kept;
  for (const Triangle& t : mesh->triangles) {
    std::vector<int> polygon;
    bool positive = false;
    for (int e = 0; e < 3; ++e) {
      const int a = t[e], b = t[(e + 1) % 3];
      if (f[a] >= 0.0) polygon.push_back(a);
      positive = positive || f[a] > 0.0;
      if (crosses(a, b)) polygon.push_back(cut(a, b));
    }
    if (!positive || polygon.size() < 3) continue;
    if (polygon.size() == 4) {
      const auto& p = mesh->vertices;
      const bool other = (p[polygon[0]] - p[polygon[2]]).norm() > (p[polygon[1]] - p[polygon[3]]).norm();
      if (other) std::rotate(polygon.begin(), polygon.begin() + 1, polygon.end());
      kept.push_back({polygon[0], polygon[2], polygon[3]});
    }
    kept.push_back({polygon[0], polygon[1], polygon[2]});
  }
  mesh->triangles = std::move(kept);
  keep_triangles(std::vector<bool>(mesh->triangles.size(), true), mesh, normals, sizes, field);
}

void keep_main_part(TriangleMesh* mesh, std::vector<Vec3>* normals, std::vector<double>* sizes,
                    std::vector<double>* field) {
  for (int round = 0; round < 8; ++round) {
    const Connectivity links = connectivity(*mesh);
    // Parts joined by edges.
    std::vector<int> part(mesh->triangles.size(), -1), stack;
    int best = -1, parts = 0;
    size_t most = 0;
    for (int t = 0; t < mesh->triangle_count(); ++t) {
      if (part[t] >= 0) continue;
      size_t count = 0;
      stack.assign(1, t);
      part[t] = parts;
      while (!stack.empty()) {
        const int at = stack.back();
        stack.pop_back();
        ++count;
        for (int n : links.neighbours[at])
          if (n >= 0 && part[n] < 0) part[n] = parts, stack.push_back(n);
      }
      if (count > most) most = count, best = parts;
      ++parts;
    }
    std::vector<bool> keep(mesh->triangles.size());
    bool changed = false;
    // A vertex on more than one stretch of boundary: a bow tie, of which one wing must go.
    std::vector<int> border(mesh->vertices.size(), 0);
    for (int t = 0; t < mesh->triangle_count(); ++t)
      for (int e = 0; e < 3; ++e)
        if (links.neighbours[t][e] < 0) ++border[mesh->triangles[t][e]];
    for (int t = 0; t < mesh->triangle_count(); ++t) {
      int free = 0;
      bool tie = false;
      for (int e = 0; e < 3; ++e) {
        free += links.neighbours[t][e] < 0;
        tie = tie || border[mesh->triangles[t][e]] > 1;
      }
      keep[t] = part[t] == best && free < 3 && !(tie && free > 0);
      changed = changed || !keep[t];
    }
    if (!changed) return;
    keep_triangles(keep, mesh, normals, sizes, field);
  }
}

}  // namespace fascia::smas
