#include "builder/tissue/remesh.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <set>

#include "builder/spatial/triangle.h"

namespace fascia::tissue {
namespace {

using Face = std::array<int, 3>;

/// A triangle mesh being changed: dead triangles are marked by a negative corner.
class Sculptor {
 public:
  Sculptor(const TriangleMesh& source, const std::vector<double>& lengths)
      : source_(source), lengths_(lengths), source_around_(triangles_around(source)) {
    points_ = source.vertices;
    faces_.assign(source.triangles.begin(), source.triangles.end());
    around_ = source_around_;
    places_.resize(points_.size());
    for (size_t v = 0; v < points_.size(); ++v) {
      if (around_[v].empty()) continue;
      places_[v].triangle = around_[v][0];
      const Face& t = faces_[at(around_[v][0])];
      for (size_t k = 0; k < 3; ++k)
        if (t[k] == static_cast<int>(v)) places_[v].barycentric[static_cast<int>(k)] = 1.0;
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
    for (const Face& f : faces_) {
      if (f[0] < 0) continue;
      fascia::Triangle t;
      for (size_t k = 0; k < 3; ++k) {
        int& i = index[at(f[k])];
        if (i < 0) {
          i = out.mesh.vertex_count();
          out.mesh.vertices.push_back(points_[at(f[k])]);
          out.source.push_back(places_[at(f[k])]);
        }
        t[k] = i;
      }
      out.mesh.triangles.push_back(t);
    }
    return out;
  }

 private:
  static size_t at(int i) { return static_cast<size_t>(i); }

  double wanted(int v) const {
    const SurfacePoint& p = places_[at(v)];
    double sum = 0.0;
    for (int k = 0; k < 3; ++k)
      sum += p.barycentric[k] * lengths_[at(source_.triangles[at(p.triangle)][at(k)])];
    return sum;
  }
  double wanted(int a, int b) const { return 0.5 * (wanted(a) + wanted(b)); }
  double length(int a, int b) const { return (points_[at(a)] - points_[at(b)]).norm(); }

  std::vector<int> shared(int a, int b) const {
    std::vector<int> out;
    for (const int f : around_[at(a)])
      if (std::find(faces_[at(f)].begin(), faces_[at(f)].end(), b) != faces_[at(f)].end()) out.push_back(f);
    return out;
  }
  std::vector<int> ring(int v) const {
    std::vector<int> out;
    for (const int f : around_[at(v)])
      for (const int c : faces_[at(f)])
        if (c != v) out.push_back(c);
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
    return out;
  }
  bool on_border(int v) const {
    for (const int n : ring(v))
      if (shared(v, n).size() != 2) return true;
    return false;
  }
  std::vector<std::pair<int, int>> edges() const {
    std::vector<std::pair<int, int>> out;
    for (const Face& f : faces_)
      if (f[0] >= 0)
        for (size_t k = 0; k < 3; ++k)
          out.emplace_back(std::min(f[k], f[(k + 1) % 3]), std::max(f[k], f[(k + 1) % 3]));
    std::sort(out.begin(), out.end());
    out.erase(std::unique(out.begin(), out.end()), out.end());
    return out;
  }
  Vec3 normal(const Face& f) const {
    return (points_[at(f[1])] - points_[at(f[0])]).cross(points_[at(f[2])] - points_[at(f[0])]);
  }
  void detach(int f, int v) {
    auto& list = around_[at(v)];
    list.erase(std::find(list.begin(), list.end(), f));
  }
  void put(int v, const Vec3& point, int start) {
    places_[at(v)] = walk_to(source_, source_around_, point, start);
    points_[at(v)] = position(source_, places_[at(v)]);
  }
  int corner_against(int f, int a, int b) const {
    for (const int c : faces_[at(f)])
      if (c != a && c != b) return c;
    return -1;
  }

  void split_long() {
    for (int round = 0; round < 4; ++round) {
      bool any = false;
      for (const auto& [a, b] : edges()) {
        if (length(a, b) <= 4.0 / 3.0 * wanted(a, b)) continue;
        const std::vector<int> both = shared(a, b);
        if (both.empty() || both.size() > 2) continue;
        any = true;
        const int middle = static_cast<int>(points_.size());
        points_.emplace_back();
        places_.emplace_back();
        around_.emplace_back();
        const Vec3 half = 0.5 * (points_[at(a)] + points_[at(b)]);
        if (both.size() ==
            1) {  // keep the border's own line: project only within the source's border triangle
          places_[at(middle)] = walk_to(source_, source_around_, half, places_[at(a)].triangle);
          points_[at(middle)] = position(source_, places_[at(middle)]);
        } else {
          put(middle, half, places_[at(a)].triangle);
        }
        for (const int f : both) {
          const int added = static_cast<int>(faces_.size());
          Face copy = faces_[at(f)];
          std::replace(copy.begin(), copy.end(), a, middle);
          std::replace(faces_[at(f)].begin(), faces_[at(f)].end(), b, middle);
          faces_.push_back(copy);
          detach(f, b);
          around_[at(b)].push_back(added);
          around_[at(middle)].push_back(f);
          around_[at(middle)].push_back(added);
          around_[at(corner_against(f, a, middle))].push_back(added);
        }
      }
      if (!any) break;
    }
  }

  bool may_collapse(int gone, int kept, const Vec3& target, const std::vector<int>& both) const {
    const std::vector<int> a = ring(gone), b = ring(kept);
    std::vector<int> common;
    std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(common));
    if (common.size() != both.size()) return false;
    for (const int v : {gone, kept}) {
      const int other = v == gone ? kept : gone;
      for (const int f : around_[at(v)]) {
        Face face = faces_[at(f)];
        if (std::find(face.begin(), face.end(), other) != face.end()) continue;
        const Vec3 before = normal(face);
        Vec3 p[3];
        for (size_t k = 0; k < 3; ++k) {
          p[k] = face[k] == v ? target : points_[at(face[k])];
          if (face[k] != v && (points_[at(face[k])] - target).norm() > 4.0 / 3.0 * wanted(kept, face[k]))
            return false;
        }
        const Vec3 after = (p[1] - p[0]).cross(p[2] - p[0]);
        if (after.dot(before) < 0.3 * after.norm() * before.norm() || after.norm() < 1e-3 * before.norm())
          return false;
      }
    }
    return true;
  }

  void collapse_short() {
    for (int round = 0; round < 6; ++round) {
      bool any = false;
      for (auto [a, b] : edges()) {
        if (around_[at(a)].empty() || around_[at(b)].empty()) continue;
        const std::vector<int> both = shared(a, b);
        if (both.empty() || both.size() > 2 || length(a, b) >= 0.8 * wanted(a, b)) continue;
        const bool border_a = on_border(a), border_b = on_border(b);
        if (border_a && border_b && both.size() == 2) continue;  // would pinch the surface
        if (border_a && !border_b) std::swap(a, b);              // b stays
        const bool keep_place = border_a != border_b;
        const Vec3 target = keep_place ? points_[at(b)] : Vec3(0.5 * (points_[at(a)] + points_[at(b)]));
        if (border_a && border_b && ring(a).size() <= 2) continue;
        if (!may_collapse(a, b, target, both)) continue;
        any = true;
        for (const int f : both) {
          for (const int c : faces_[at(f)])
            detach(f, c);
          faces_[at(f)] = {-1, -1, -1};
        }
        for (const int f : around_[at(a)]) {
          std::replace(faces_[at(f)].begin(), faces_[at(f)].end(), a, b);
          around_[at(b)].push_back(f);
        }
        around_[at(a)].clear();
        if (!keep_place) put(b, target, places_[at(b)].triangle);
      }
      if (!any) break;
    }
  }

  double angle_at(int c, int a, int b) const {
    const Vec3 u = points_[at(a)] - points_[at(c)], v = points_[at(b)] - points_[at(c)];
    return std::atan2(u.cross(v).norm(), u.dot(v));
  }

  void flip() {
    for (int round = 0; round < 3; ++round) {
      bool any = false;
      for (const auto& [a, b] : edges()) {
        const std::vector<int> both = shared(a, b);
        if (both.size() != 2) continue;
        const int c = corner_against(both[0], a, b), d = corner_against(both[1], a, b);
        if (c == d || angle_at(c, a, b) + angle_at(d, a, b) <= 3.1416 + 0.05 || !shared(c, d).empty())
          continue;
        const Vec3 n0 = normal(faces_[at(both[0])]), n1 = normal(faces_[at(both[1])]);
        // New faces keep the old ones' direction: in face both[0] the edge runs a -> b or b -> a.
        const Face& f0 = faces_[at(both[0])];
        size_t k = 0;
        while (f0[k] != a)
          ++k;
        const bool forward = f0[(k + 1) % 3] == b;
        const Face first = forward ? Face{a, d, c} : Face{a, c, d},
                   second = forward ? Face{b, c, d} : Face{b, d, c};
        const Vec3 mean = n0.normalized() + n1.normalized(), m0 = normal(first), m1 = normal(second);
        if (m0.dot(mean) <= 0.5 * m0.norm() * mean.norm() || m1.dot(mean) <= 0.5 * m1.norm() * mean.norm())
          continue;
        any = true;
        detach(both[0], b);
        detach(both[1], a);
        faces_[at(both[0])] = first;
        faces_[at(both[1])] = second;
        around_[at(d)].push_back(both[0]);
        around_[at(c)].push_back(both[1]);
      }
      if (!any) break;
    }
  }

  void smooth() {
    for (size_t v = 0; v < points_.size(); ++v) {
      const int i = static_cast<int>(v);
      if (around_[v].empty() || on_border(i)) continue;
      Vec3 sum = Vec3::Zero(), up = Vec3::Zero();
      double weight = 0.0;
      for (const int f : around_[v]) {
        const Face& t = faces_[at(f)];
        const Vec3 n = normal(t);
        const double size = wanted(t[0]) + wanted(t[1]) + wanted(t[2]);
        const double w = n.norm() / (size * size);
        sum += w * (points_[at(t[0])] + points_[at(t[1])] + points_[at(t[2])]) / 3.0;
        weight += w;
        up += n;
      }
      if (weight <= 0.0 || up.norm() == 0.0) continue;
      up.normalize();
      Vec3 move = sum / weight - points_[v];
      move -= up.dot(move) * up;
      const Vec3 old_point = points_[v];
      const SurfacePoint old_place = places_[v];
      std::vector<Vec3> before;
      for (const int f : around_[v])
        before.push_back(normal(faces_[at(f)]));
      put(i, points_[v] + 0.7 * move, places_[v].triangle);
      for (size_t k = 0; k < before.size(); ++k) {
        const Vec3 after = normal(faces_[at(around_[v][k])]);
        if (after.dot(before[k]) < 0.3 * after.norm() * before[k].norm()) {  // turned a triangle: stay
          points_[v] = old_point;
          places_[v] = old_place;
          break;
        }
      }
    }
  }

  const TriangleMesh& source_;
  const std::vector<double>& lengths_;
  std::vector<std::vector<int>> source_around_;
  std::vector<Vec3> points_;
  std::vector<SurfacePoint> places_;
  std::vector<Face> faces_;
  std::vector<std::vector<int>> around_;
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
