#include "tools/anatomy/skull/thin_out.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <functional>
#include <iterator>
#include <queue>
#include <tuple>
#include <utility>

#include "geometry/connectivity.h"
#include "geometry/half_edges.h"

namespace fascia::skull_maker {
namespace {

struct Collapser {
  const std::vector<Vec3>& points;
  const std::vector<double>& sizes;
  const std::vector<Vec3>& normals;
  HalfEdges links;

  const Vec3& at(int v) const { return points[static_cast<std::size_t>(v)]; }
  bool is_gone(int v) const { return links.leaving[static_cast<std::size_t>(v)] < 0; }

  double shortness(int a, int b) const {
    return (at(a) - at(b)).norm() * 2 /
           (sizes[static_cast<std::size_t>(a)] + sizes[static_cast<std::size_t>(b)]);
  }

  /// Whether the triangle of corners `from`, `b`, `c` stays sound with `to` for `from`.
  bool stays_sound(int to, int b, int c) const {
    const Vec3 after = (at(b) - at(to)).cross(at(c) - at(to));
    const double longest = std::max(
        {(at(to) - at(b)).squaredNorm(), (at(b) - at(c)).squaredNorm(), (at(c) - at(to)).squaredNorm()});
    return after.norm() >= 0.06 * longest &&
           after.dot(normals[static_cast<std::size_t>(to)]) >= 0.3 * after.norm();
  }

  /// May the end of `h` other than `to` be merged into `to`?
  bool allowed(int h, int to) const {
    const int from = links.from(h) == to ? links.to(h) : links.from(h);
    const std::size_t wings = links.across(h) < 0 ? 1 : 2;
    if (links.on_boundary(from) ? wings == 2 : wings == 1) return false;
    std::vector<int> a, b, shared;
    links.ring(from, a);
    links.ring(to, b);
    std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(shared));
    if (shared.size() != wings || a.size() < 4 || !links.may_edit(h)) return false;
    for (const int w : a) {
      if (w != to && shortness(w, to) > 1.7) return false;
    }
    bool sound = true;
    links.around(from, [&](int k) {
      if (links.to(k) != to && links.apex(k) != to)
        sound = sound && stays_sound(to, links.to(k), links.apex(k));
    });
    return sound;
  }
};

}  // namespace

void thin_out(double share, const std::vector<Vec3>& normals, TriangleMesh* mesh,
              std::vector<double>* sizes) {
  Collapser work{mesh->vertices, *sizes, normals, HalfEdges(*mesh)};
  using Candidate = std::tuple<double, int, int>;
  std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> queue;
  std::vector<int> ring;
  const auto consider = [&](int v) {
    work.links.ring(v, ring);
    for (const int w : ring) {
      const double shortness = work.shortness(v, w);
      if (shortness < share) queue.push({shortness, v, w}), queue.push({shortness, w, v});
    }
  };
  // What was not allowed at first may be later, when the neighbours have gone.
  int collapsed = 0;
  const auto refill = [&] {
    if (!queue.empty()) return;
    for (int v = 0; v < mesh->vertex_count(); ++v)
      consider(v);
  };
  refill();
  while (!queue.empty()) {
    const auto [shortness, from, to] = queue.top();
    queue.pop();
    if (queue.empty() && collapsed > 0) {
      collapsed = 0;
      refill();
    }
    if (work.is_gone(from) || work.is_gone(to)) continue;
    const int h = work.links.find_either(from, to);
    if (h < 0 || !work.allowed(h, to)) continue;
    work.links.collapse(h, to);
    ++collapsed;
    consider(to);
  }
  std::vector<bool> keep;
  for (int h = 0; h < static_cast<int>(work.links.twin.size()); h += 3)
    keep.push_back(!work.links.gone(h));
  std::vector<int> map;
  // Numbered in the order of the triangles: what comes next works on them in that order.
  const TriangleMesh out = submesh({mesh->vertices, work.links.triangles}, keep, &map);
  std::vector<double> lengths(out.vertices.size());
  for (std::size_t v = 0; v < map.size(); ++v) {
    if (map[v] >= 0) lengths[static_cast<std::size_t>(map[v])] = (*sizes)[v];
  }
  *mesh = out;
  *sizes = std::move(lengths);
}

}  // namespace fascia::skull_maker
