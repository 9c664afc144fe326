#include "geometry/flaps.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
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

namespace {

/// Areas of patches, by their roots.
std::vector<double> patch_areas(const TriangleMesh& mesh, const Patches& patches) {
  std::vector<double> area(mesh.triangles.size(), 0.0);
  for (int t = 0; t < mesh.triangle_count(); ++t)
    area[static_cast<size_t>(patches.root_of(t).first)] += triangle_area(mesh, t);
  return area;
}

using EdgeSides = std::vector<HalfEdge>;

/// The sides of a crowded edge in pairs across the air between them: none unless there are four whose outer
/// sides alternate around it.
std::vector<std::pair<int, int>> across_air(const TriangleMesh& mesh, const EdgeSides& sides) {
  if (sides.size() != 4) return {};
  const Vec3 &low = mesh.vertices[static_cast<size_t>(sides[0].low)],
             &high = mesh.vertices[static_cast<size_t>(sides[0].high)];
  const Vec3 along = high - low;
  if (!(along.norm() > 0.0)) return {};
  const Vec3 right = along.unitOrthogonal(), up = along.normalized().cross(right);
  std::vector<std::pair<double, HalfEdge>> around;
  for (const HalfEdge& side : sides) {
    const Triangle& t = mesh.triangles[static_cast<size_t>(side.triangle)];
    const Vec3 arm = mesh.vertices[static_cast<size_t>(t[static_cast<size_t>(side.edge + 2) % 3])] - low;
    around.emplace_back(std::atan2(arm.dot(up), arm.dot(right)), side);
  }
  std::sort(around.begin(), around.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<std::pair<int, int>> pairs;
  for (size_t k = 0; k < 4; ++k) {
    const HalfEdge &here = around[k].second, &next = around[(k + 1) % 4].second;
    if (here.forward == next.forward) return {};
    // The outer side of a triangle whose side runs forward lies on from it as the angle grows.
    if (here.forward) pairs.emplace_back(here.triangle, next.triangle);
  }
  return pairs;
}

/// Which patches, by root, hang between others on all their crowded edges.
std::vector<bool> hanging_patches(const TriangleMesh& mesh, const std::vector<HalfEdge>& edges,
                                  const Patches& patches, double largest) {
  const std::vector<double> area = patch_areas(mesh, patches);
  double total = 0.0;
  for (const double a : area)
    total += a;
  std::vector<bool> hangs(mesh.triangles.size(), false), stays(hangs);
  for_each_edge(edges, [&](auto first, auto last) {
    if (last - first == 2) return;
    const EdgeSides sides(first, last);
    const auto pairs = across_air(mesh, sides);
    for (const HalfEdge& side : sides) {
      const auto root = [&](int t) { return static_cast<size_t>(patches.root_of(t).first); };
      const size_t patch = root(side.triangle);
      const bool is_between = pairs.size() == 2 && std::all_of(pairs.begin(), pairs.end(), [&](auto& pair) {
                                return (root(pair.first) == patch) != (root(pair.second) == patch);
                              });
      (is_between && area[patch] < largest * total ? hangs : stays)[patch] = true;
    }
  });
  for (size_t p = 0; p < hangs.size(); ++p)
    hangs[p] = hangs[p] && !stays[p];
  return hangs;
}

}  // namespace

TriangleMesh with_hanging_patches_joined(const TriangleMesh& mesh, double largest) {
  const std::vector<HalfEdge> edges = sorted_half_edges(mesh.triangles, mesh.vertices.size());
  const Patches patches = patches_of(mesh, edges);
  const std::vector<bool> hangs = hanging_patches(mesh, edges, patches, largest);
  if (std::find(hangs.begin(), hangs.end(), true) == hangs.end()) return mesh;
  // Corners that are one place of the surface: those on either side of an edge that is opened or was none.
  Patches corners(3 * mesh.triangles.size());
  std::vector<bool> is_opened(mesh.vertices.size(), false);
  const auto corner_of = [&](int triangle, int vertex) {
    const Triangle& t = mesh.triangles[static_cast<size_t>(triangle)];
    return 3 * triangle + static_cast<int>(std::find(t.begin(), t.end(), vertex) - t.begin());
  };
  for_each_edge(edges, [&](auto first, auto last) {
    const EdgeSides sides(first, last);
    std::vector<std::pair<int, int>> pairs;
    const bool is_hanging = std::any_of(sides.begin(), sides.end(), [&](const HalfEdge& side) {
      return hangs[static_cast<size_t>(patches.root_of(side.triangle).first)];
    });
    if (sides.size() > 2 && is_hanging)
      pairs = across_air(mesh, sides);
    else
      for (size_t k = 1; k < sides.size(); ++k)
        pairs.emplace_back(sides[0].triangle, sides[k].triangle);
    for (const int v : {first->low, first->high}) {
      is_opened[static_cast<size_t>(v)] =
          is_opened[static_cast<size_t>(v)] || (sides.size() > 2 && is_hanging);
      for (const auto& [a, b] : pairs)
        corners.join(corner_of(a, v), corner_of(b, v), false);
    }
  });
  const std::vector<double> area = patch_areas(mesh, patches);
  std::map<int, std::map<int, double>> fans;  // vertex -> root of its corners -> area of their patches
  for (int t = 0; t < mesh.triangle_count(); ++t)
    for (int k = 0; k < 3; ++k) {
      const int v = mesh.triangles[static_cast<size_t>(t)][static_cast<size_t>(k)];
      if (!is_opened[static_cast<size_t>(v)]) continue;
      double& largest_patch = fans[v][corners.root_of(3 * t + k).first];
      largest_patch = std::max(largest_patch, area[static_cast<size_t>(patches.root_of(t).first)]);
    }
  TriangleMesh result = mesh;
  std::map<int, int> vertex_of;  // root of corners -> vertex
  for (const auto& [v, roots] : fans) {
    const auto own = std::max_element(roots.begin(), roots.end(),
                                      [](const auto& a, const auto& b) { return a.second < b.second; });
    for (const auto& [root, size] : roots) {
      vertex_of[root] = root == own->first ? v : result.vertex_count();
      if (root != own->first) result.vertices.push_back(mesh.vertices[static_cast<size_t>(v)]);
    }
  }
  for (int t = 0; t < mesh.triangle_count(); ++t)
    for (int k = 0; k < 3; ++k) {
      int& v = result.triangles[static_cast<size_t>(t)][static_cast<size_t>(k)];
      if (is_opened[static_cast<size_t>(v)]) v = vertex_of.at(corners.root_of(3 * t + k).first);
    }
  return result;
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
