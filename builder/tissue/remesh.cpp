#include "builder/tissue/remesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "builder/spatial/triangle.h"
#include "geometry/half_edges.h"

namespace fascia::tissue {
namespace {

/// A surface being remeshed: its half-edges, where its vertices are, and which point of the source each is.
class Sculptor {
 public:
  Sculptor(const TriangleMesh& source, const std::vector<double>& lengths)
      : source_(source),
        lengths_(lengths),
        source_around_(triangles_around(source)),
        links_(source),
        points_(source.vertices),
        places_(source.vertices.size()) {
    for (int v = 0; v < source.vertex_count(); ++v) {
      if (source_around_[v].empty()) continue;
      places_[v].triangle = source_around_[v][0];
      for (int k = 0; k < 3; ++k)
        if (source.triangles[places_[v].triangle][k] == v) places_[v].barycentric[k] = 1.0;
    }
  }

  void pass(bool last) {
    split_long();
    collapse_short();
    flip();
    smooth();
    if (last) flip();
  }

  RemeshResult result() const {
    RemeshResult out;
    std::vector<int> index(points_.size(), -1);
    for (const fascia::Triangle& corners : links_.triangles) {
      fascia::Triangle t;
      for (int k = 0; k < 3; ++k) {
        int& i = index[corners[k]];
        if (i < 0) {
          i = out.mesh.vertex_count();
          out.mesh.vertices.push_back(points_[corners[k]]);
          out.source.push_back(places_[corners[k]]);
        }
        t[k] = i;
      }
      out.mesh.triangles.push_back(t);
    }
    return out;
  }

 private:
  double wanted(int v) const {
    const SurfacePoint& p = places_[v];
    double sum = 0.0;
    for (int k = 0; k < 3; ++k)
      sum += p.barycentric[k] * lengths_[source_.triangles[p.triangle][k]];
    return sum;
  }
  double wanted(int a, int b) const { return 0.5 * (wanted(a) + wanted(b)); }
  double length(int a, int b) const { return (points_[a] - points_[b]).norm(); }

  /// Every edge by its ends, the lower first, ascending: the order does not depend on that of the triangles.
  std::vector<std::pair<int, int>> edges() const {
    std::vector<std::pair<int, int>> out;
    for (int h = 0; h < static_cast<int>(links_.twin.size()); ++h) {
      if (links_.gone(h)) continue;
      const int a = links_.from(h), b = links_.to(h);
      if (links_.across(h) < 0 || a < b) out.emplace_back(std::min(a, b), std::max(a, b));
    }
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
    return out;
  }
  Vec3 normal(const Vec3& a, const Vec3& b, const Vec3& c) const { return (b - a).cross(c - a); }
  Vec3 normal(int h) const {
    return normal(points_[links_.from(h)], points_[links_.to(h)], points_[links_.apex(h)]);
  }
  void put(int v, const Vec3& point, int start) {
    places_[v] = walk_to(source_, source_around_, point, start);
    points_[v] = position(source_, places_[v]);
  }

  void split_long() {
    for (int round = 0; round < 4; ++round) {
      bool any = false;
      for (const auto& [a, b] : edges()) {
        if (length(a, b) <= 4.0 / 3.0 * wanted(a, b)) continue;
        const int h = links_.find_either(a, b);
        if (h < 0 || !links_.may_edit(h)) continue;
        any = true;
        const int middle = links_.split(h);
        points_.emplace_back();
        places_.emplace_back();
        put(middle, 0.5 * (points_[a] + points_[b]), places_[a].triangle);
      }
      if (!any) break;
    }
  }

  /// Whether the ends of `h` can be merged at `target`: the mesh stays manifold (link condition), nothing
  /// folds or becomes too long.
  bool may_collapse(int h, int gone, int kept, const Vec3& target) const {
    std::vector<int> a, b, common;
    links_.ring(gone, a);
    links_.ring(kept, b);
    std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(common));
    if (common.size() != (links_.across(h) < 0 ? 1 : 2)) return false;
    bool may = true;
    for (const int v : {gone, kept}) {
      const int other = v == gone ? kept : gone;
      links_.around(v, [&](int k) {
        const int c = links_.to(k), d = links_.apex(k);
        if (!may || c == other || d == other) return;
        const Vec3 before = normal(k), after = normal(target, points_[c], points_[d]);
        for (const int w : {c, d})
          may = may && (points_[w] - target).norm() <= 4.0 / 3.0 * wanted(kept, w);
        may = may && after.dot(before) >= 0.3 * after.norm() * before.norm() &&
              after.norm() >= 1e-3 * before.norm();
      });
    }
    return may;
  }

  void collapse_short() {
    for (int round = 0; round < 6; ++round) {
      bool any = false;
      for (auto [a, b] : edges()) {
        if (length(a, b) >= 0.8 * wanted(a, b)) continue;
        const int h = links_.find_either(a, b);
        if (h < 0 || !links_.may_edit(h)) continue;
        const bool border_a = links_.on_boundary(a), border_b = links_.on_boundary(b);
        if (border_a && border_b && links_.across(h) >= 0) continue;  // would pinch the surface
        if (border_a && !border_b) std::swap(a, b);                   // b stays
        const bool keep_place = border_a != border_b;
        const Vec3 target = keep_place ? points_[b] : Vec3(0.5 * (points_[a] + points_[b]));
        if (border_a && border_b && links_.valence(a) < 2) continue;
        if (!may_collapse(h, a, b, target)) continue;
        any = true;
        links_.collapse(h, b);
        if (!keep_place) put(b, target, places_[b].triangle);
      }
      if (!any) break;
    }
    const std::vector<int> stay = links_.compact();
    keep_only(stay, points_);
    keep_only(stay, places_);
  }

  double angle_at(int c, int a, int b) const {
    const Vec3 u = points_[a] - points_[c], v = points_[b] - points_[c];
    return std::atan2(u.cross(v).norm(), u.dot(v));
  }

  void flip() {
    for (int round = 0; round < 3; ++round) {
      bool any = false;
      for (const auto& [low, high] : edges()) {
        const int h = links_.find(low, high);
        if (h < 0 || links_.across(h) < 0 || !links_.may_edit(h)) continue;
        const int a = low, b = high, c = links_.apex(h), d = links_.apex(links_.across(h));
        if (c == d || angle_at(c, a, b) + angle_at(d, a, b) <= 3.1416 + 0.05 || links_.find_either(c, d) >= 0)
          continue;
        const Vec3 mean = normal(h).normalized() + normal(links_.across(h)).normalized(),
                   first = normal(points_[a], points_[d], points_[c]),
                   second = normal(points_[b], points_[c], points_[d]);
        if (first.dot(mean) <= 0.5 * first.norm() * mean.norm() ||
            second.dot(mean) <= 0.5 * second.norm() * mean.norm())
          continue;
        any = true;
        links_.flip(h);
      }
      if (!any) break;
    }
  }

  void smooth() {
    for (int v = 0; v < static_cast<int>(points_.size()); ++v) {
      if (links_.leaving[v] < 0 || links_.on_boundary(v) || links_.fixed[v]) continue;
      Vec3 sum = Vec3::Zero(), up = Vec3::Zero();
      double weight = 0.0;
      std::vector<std::pair<int, Vec3>> before;
      links_.around(v, [&](int h) {
        const int b = links_.to(h), c = links_.apex(h);
        const Vec3 n = normal(h);
        const double size = wanted(v) + wanted(b) + wanted(c), w = n.norm() / (size * size);
        sum += w * (points_[v] + points_[b] + points_[c]) / 3.0;
        weight += w;
        up += n;
        before.emplace_back(h, n);
      });
      if (weight <= 0.0 || up.norm() == 0.0) continue;
      up.normalize();
      Vec3 move = sum / weight - points_[v];
      move -= up.dot(move) * up;
      const Vec3 old_point = points_[v];
      const SurfacePoint old_place = places_[v];
      put(v, points_[v] + 0.7 * move, places_[v].triangle);
      const bool turns = std::any_of(before.begin(), before.end(), [&](const std::pair<int, Vec3>& triangle) {
        const Vec3 after = normal(triangle.first);
        return after.dot(triangle.second) < 0.3 * after.norm() * triangle.second.norm();
      });
      if (!turns) continue;
      points_[v] = old_point;
      places_[v] = old_place;
    }
  }

  const TriangleMesh& source_;
  const std::vector<double>& lengths_;
  std::vector<std::vector<int>> source_around_;
  HalfEdges links_;
  std::vector<Vec3> points_;
  std::vector<SurfacePoint> places_;
};

}  // namespace

std::vector<std::vector<int>> triangles_around(const TriangleMesh& mesh) {
  std::vector<std::vector<int>> around(mesh.vertices.size());
  for (size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const int c : mesh.triangles[t])
      around[static_cast<size_t>(c)].push_back(static_cast<int>(t));
  return around;
}

SurfacePoint walk_to(const TriangleMesh& mesh, const std::vector<std::vector<int>>& around, const Vec3& point,
                     int start) {
  const auto foot = [&](int t) {
    const fascia::Triangle& c = mesh.triangles[static_cast<size_t>(t)];
    const auto corner = [&](size_t k) -> const Vec3& { return mesh.vertices[static_cast<size_t>(c[k])]; };
    return SurfacePoint{t, spatial::closest_barycentric(point, corner(0), corner(1), corner(2))};
  };
  SurfacePoint best = foot(start);
  double distance = (position(mesh, best) - point).squaredNorm();
  for (int steps = 0; steps < 64; ++steps) {
    const SurfacePoint before = best;
    for (const int corner : mesh.triangles[static_cast<size_t>(before.triangle)])
      for (const int t : around[static_cast<size_t>(corner)]) {
        const SurfacePoint candidate = foot(t);
        const double d = (position(mesh, candidate) - point).squaredNorm();
        if (d < distance) {
          distance = d;
          best = candidate;
        }
      }
    if (best.triangle == before.triangle) break;
  }
  return best;
}

double edge_scale_for(const TriangleMesh& source, const std::vector<double>& edge_length, int vertices) {
  // An equilateral mesh has an area of sqrt(3)/2 edge^2 a vertex.
  double count = 0.0;
  for (int t = 0; t < source.triangle_count(); ++t) {
    double mean = 0.0;
    for (const int c : source.triangles[static_cast<size_t>(t)])
      mean += edge_length[static_cast<size_t>(c)] / 3.0;
    count += triangle_area(source, t) / (0.8660254 * mean * mean);
  }
  return std::sqrt(count / vertices);
}

RemeshResult remesh(const TriangleMesh& source, const std::vector<double>& edge_length,
                    const RemeshOptions& options) {
  Sculptor sculptor(source, edge_length);
  for (int pass = 0; pass < options.passes; ++pass)
    sculptor.pass(pass + 1 == options.passes);
  return sculptor.result();
}

}  // namespace fascia::tissue
