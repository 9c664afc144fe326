#include "tools/anatomy/skull/thin_out.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <queue>
#include <tuple>

#include "geometry/connectivity.h"

namespace fascia::skull_maker {
namespace {

struct Collapser {
  TriangleMesh& mesh;
  const std::vector<double>& sizes;
  const std::vector<Vec3>& normals;
  std::vector<std::vector<int>> fans;  ///< live triangles around each vertex
  std::vector<bool> dead;              ///< triangles
  std::vector<bool> gone;              ///< vertices
  std::vector<bool> border;

  const Vec3& at(int v) const { return mesh.vertices[static_cast<std::size_t>(v)]; }
  Triangle& triangle(int t) { return mesh.triangles[static_cast<std::size_t>(t)]; }
  std::vector<int>& fan(int v) { return fans[static_cast<std::size_t>(v)]; }

  double shortness(int a, int b) const {
    return (at(a) - at(b)).norm() * 2 /
           (sizes[static_cast<std::size_t>(a)] + sizes[static_cast<std::size_t>(b)]);
  }

  std::vector<int> ring(int v) {
    std::vector<int> out;
    for (const int t : fan(v)) {
      for (const int w : triangle(t)) {
        if (w != v) out.push_back(w);
      }
    }
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
    return out;
  }

  static bool has(const Triangle& t, int v) { return t[0] == v || t[1] == v || t[2] == v; }

  Vec3 area_normal(const Triangle& t) const { return (at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0])); }

  /// May `from` move to `to`?
  bool allowed(int from, int to) {
    int wings = 0;
    for (const int t : fan(from))
      wings += has(triangle(t), to);
    const bool at_border = border[static_cast<std::size_t>(from)];
    if (at_border && !(border[static_cast<std::size_t>(to)] && wings == 1)) return false;
    if (!at_border && wings != 2) return false;
    const std::vector<int> a = ring(from);
    const std::vector<int> b = ring(to);
    std::vector<int> shared;
    std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(shared));
    if (static_cast<int>(shared.size()) != wings || a.size() < 4) return false;
    for (const int w : a) {
      if (w != to && shortness(w, to) > 1.7) return false;
    }
    for (const int t : fan(from)) {
      Triangle moved = triangle(t);
      if (has(moved, to)) continue;
      for (int& v : moved)
        v = v == from ? to : v;
      const Vec3 after = area_normal(moved);
      const double longest =
          std::max({(at(moved[0]) - at(moved[1])).squaredNorm(), (at(moved[1]) - at(moved[2])).squaredNorm(),
                    (at(moved[2]) - at(moved[0])).squaredNorm()});
      if (after.norm() < 0.06 * longest ||
          after.dot(normals[static_cast<std::size_t>(to)]) < 0.3 * after.norm()) {
        return false;
      }
    }
    return true;
  }

  void collapse(int from, int to) {
    for (const int t : fan(from)) {
      Triangle& corners = triangle(t);
      if (has(corners, to)) {
        dead[static_cast<std::size_t>(t)] = true;
        for (const int w : corners) {
          if (w != from) std::erase(fan(w), t);
        }
      } else {
        for (int& v : corners)
          v = v == from ? to : v;
        fan(to).push_back(t);
      }
    }
    fan(from).clear();
    gone[static_cast<std::size_t>(from)] = true;
  }
};

}  // namespace

void thin_out(double share, const std::vector<Vec3>& normals, TriangleMesh* mesh,
              std::vector<double>* sizes) {
  const std::size_t count = mesh->vertices.size();
  Collapser work{*mesh,
                 *sizes,
                 normals,
                 std::vector<std::vector<int>>(count),
                 std::vector<bool>(mesh->triangles.size(), false),
                 std::vector<bool>(count, false),
                 std::vector<bool>(count, false)};
  for (int t = 0; t < mesh->triangle_count(); ++t) {
    for (const int v : work.triangle(t))
      work.fan(v).push_back(t);
  }
  for (const auto& loop : boundary_loops(*mesh, connectivity(*mesh))) {
    for (const int v : loop)
      work.border[static_cast<std::size_t>(v)] = true;
  }
  using Candidate = std::tuple<double, int, int>;
  std::priority_queue<Candidate, std::vector<Candidate>, std::greater<>> queue;
  const auto consider = [&](int v) {
    for (const int w : work.ring(v)) {
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
    if (work.gone[static_cast<std::size_t>(from)] || work.gone[static_cast<std::size_t>(to)]) continue;
    const std::vector<int> near = work.ring(from);
    if (!std::binary_search(near.begin(), near.end(), to) || !work.allowed(from, to)) continue;
    work.collapse(from, to);
    ++collapsed;
    consider(to);
  }
  std::vector<bool> keep;
  for (const bool is_dead : work.dead)
    keep.push_back(!is_dead);
  std::vector<int> map;
  const TriangleMesh out = submesh(*mesh, keep, &map);
  std::vector<double> lengths(out.vertices.size());
  for (std::size_t v = 0; v < map.size(); ++v) {
    if (map[v] >= 0) lengths[static_cast<std::size_t>(map[v])] = (*sizes)[v];
  }
  *mesh = out;
  *sizes = std::move(lengths);
}

}  // namespace fascia::skull_maker
