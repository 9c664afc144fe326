#include "geometry/flaps.h"

#include <algorithm>
#include <array>
#include <map>
#include <numeric>

namespace fascia {
namespace {

/// Calls `visit(first, last)` for the half edges of each edge.
template <class Visit>
void for_each_edge(const std::vector<HalfEdge>& edges, Visit visit) {
  for (size_t i = 0; i < edges.size();) {
    size_t j = i + 1;
    while (j < edges.size() && edges[j].low == edges[i].low && edges[j].high == edges[i].high)
      ++j;
    visit(edges.begin() + static_cast<std::ptrdiff_t>(i), edges.begin() + static_cast<std::ptrdiff_t>(j));
    i = j;
  }
}

/// Union-find over triangles, with the orientation of each relative to its root.
class Patches {
 public:
  explicit Patches(size_t count) : parent_(count), turned_(count, false) {
    std::iota(parent_.begin(), parent_.end(), 0);
  }
  std::pair<int, bool> root_of(int t) const {
    bool turned = false;
    for (; parent_[static_cast<size_t>(t)] != t; t = parent_[static_cast<size_t>(t)])
      turned ^= turned_[static_cast<size_t>(t)];
    return {t, turned};
  }
  /// The smaller number becomes the root. If both are connected already, the first assignment holds.
  void join(int a, int b, bool against) {
    const auto [p, p_turned] = compressed(a);
    const auto [q, q_turned] = compressed(b);
    if (p == q) return;
    const int root = std::min(p, q), other = std::max(p, q);
    parent_[static_cast<size_t>(other)] = root;
    turned_[static_cast<size_t>(other)] = p_turned ^ q_turned ^ against;
  }

 private:
  std::pair<int, bool> compressed(int t) {
    const auto [root, turned] = root_of(t);
    bool above = turned;
    while (t != root) {
      const auto i = static_cast<size_t>(t);
      const bool own = turned_[i];
      t = parent_[i];
      parent_[i] = root;
      turned_[i] = above;
      above ^= own;
    }
    return {root, turned};
  }
  std::vector<int> parent_;
  std::vector<bool> turned_;  ///< against the parent
};

void join_neighbours(const std::vector<HalfEdge>& edges, Patches& patches) {
  for_each_edge(edges, [&](auto first, auto last) {
    if (last - first == 2)
      patches.join(first->triangle, (first + 1)->triangle, first->forward == (first + 1)->forward);
  });
}

Patches patches_of(const TriangleMesh& mesh, const std::vector<HalfEdge>& edges) {
  Patches patches(mesh.triangles.size());
  join_neighbours(edges, patches);
  return patches;
}

size_t vertex_count(const std::vector<Triangle>& triangles) {
  int most = -1;
  for (const Triangle& t : triangles)
    most = std::max({most, t[0], t[1], t[2]});
  return static_cast<size_t>(most + 1);
}

}  // namespace

std::vector<bool> without_flaps(const TriangleMesh& mesh, double largest) {
  std::vector<bool> kept(mesh.triangles.size(), true);
  const std::vector<HalfEdge> edges = sorted_half_edges(mesh.triangles, mesh.vertices.size());
  std::vector<std::vector<int>> crowded;  // the triangles of each edge that has more than two
  for_each_edge(edges, [&](auto first, auto last) {
    if (last - first <= 2) return;
    crowded.emplace_back();
    for (auto edge = first; edge != last; ++edge)
      crowded.back().push_back(edge->triangle);
  });
  if (crowded.empty()) return kept;
  const Patches patches = patches_of(mesh, edges);
  std::vector<double> area(mesh.triangles.size(), 0.0);
  double total = 0.0;
  for (int t = 0; t < mesh.triangle_count(); ++t) {
    const double a = triangle_area(mesh, t);
    area[static_cast<size_t>(patches.root_of(t).first)] += a;
    total += a;
  }
  std::map<int, std::vector<size_t>> edges_of;  // small patch -> crowded edges
  for (size_t e = 0; e < crowded.size(); ++e)
    for (int& t : crowded[e]) {
      t = patches.root_of(t).first;
      if (area[static_cast<size_t>(t)] < largest * total) edges_of[t].push_back(e);
    }
  std::vector<std::pair<double, int>> small;
  for (const auto& [patch, at] : edges_of)
    small.emplace_back(area[static_cast<size_t>(patch)], patch);
  std::sort(small.begin(), small.end());
  std::vector<bool> gone(mesh.triangles.size(), false);  // by patch
  for (const auto& [size, patch] : small) {
    // It is spare when every edge it hangs on keeps two triangles without it.
    const auto is_full = [&, own = patch](size_t edge) {
      return std::count_if(crowded[edge].begin(), crowded[edge].end(),
                           [&](int other) { return other != own && !gone[static_cast<size_t>(other)]; }) >= 2;
    };
    const std::vector<size_t>& at = edges_of[patch];
    gone[static_cast<size_t>(patch)] = std::all_of(at.begin(), at.end(), is_full);
  }
  for (int t = 0; t < mesh.triangle_count(); ++t)
    kept[static_cast<size_t>(t)] = !gone[static_cast<size_t>(patches.root_of(t).first)];
  return kept;
}

std::vector<bool> facing_against(const TriangleMesh& mesh, const std::vector<Triangle>& original) {
  Patches patches(mesh.triangles.size());
  join_neighbours(sorted_half_edges(original, vertex_count(original)), patches);
  join_neighbours(sorted_half_edges(mesh.triangles, mesh.vertices.size()), patches);
  std::vector<std::array<double, 2>> area(mesh.triangles.size(), {0.0, 0.0});
  std::vector<bool> against(mesh.triangles.size(), false);
  std::vector<int> root(mesh.triangles.size());
  for (int t = 0; t < mesh.triangle_count(); ++t) {
    const auto [patch, turned] = patches.root_of(t);
    root[static_cast<size_t>(t)] = patch;
    against[static_cast<size_t>(t)] = turned;
    area[static_cast<size_t>(patch)][turned] += triangle_area(mesh, t);
  }
  for (size_t t = 0; t < against.size(); ++t) {
    const auto& sides = area[static_cast<size_t>(root[t])];
    if (sides[1] > sides[0]) against[t] = !against[t];
  }
  return against;
}

}  // namespace fascia
