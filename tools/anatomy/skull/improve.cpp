#include "tools/anatomy/skull/improve.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <unordered_set>

#include "geometry/connectivity.h"

namespace fascia::skull_maker {

namespace {

double angle_at(const Vec3& a, const Vec3& b, const Vec3& c) {
  return std::atan2((b - a).cross(c - a).norm(), (b - a).dot(c - a));
}

double smallest_angle(const Vec3& a, const Vec3& b, const Vec3& c) {
  return std::min({angle_at(a, b, c), angle_at(b, c, a), angle_at(c, a, b)});
}

uint64_t edge_key(int a, int b) {
  return static_cast<uint64_t>(std::min(a, b)) << 32 | static_cast<uint32_t>(std::max(a, b));
}

class Improver {
 public:
  Improver(const smas::ImplicitFunction& function, const smas::QualityOptions& options, TriangleMesh* mesh,
           std::vector<Vec3>* normals, std::vector<double>* sizes)
      : function_(function), options_(options), mesh_(*mesh), normals_(*normals), sizes_(*sizes) {}

  void split();
  void collapse();
  void flip();
  void smooth(bool exact);
  void relax_worst(double below);
  void settle();
  long evaluations() const { return evaluations_; }

 private:
  const Vec3& at(int v) const { return mesh_.vertices[v]; }
  double length(int a, int b) const { return (at(a) - at(b)).norm(); }
  double wanted(int a, int b) const { return 0.5 * (sizes_[a] + sizes_[b]); }
  bool project(Vec3* point, Vec3* normal, double reach);
  std::vector<bool> boundary_vertices(const Connectivity& links) const;
  std::vector<std::array<int, 2>> boundary_neighbours(const Connectivity& links) const;
  bool upright(int a, int b, int c, const Vec3& pa, const Vec3& pb, const Vec3& pc) const;
  bool can_collapse(const Connectivity& links, int from, int to) const;
  bool fits(const Connectivity& links, int v, const Vec3& point) const;
  bool flip_edge(Connectivity* links, std::unordered_set<uint64_t>* edges, int t, int e);
  void follow_curvature(const Connectivity& links, int v, const Vec3& step, Vec3* point, Vec3* normal) const;

  const smas::ImplicitFunction& function_;
  const smas::QualityOptions& options_;
  TriangleMesh& mesh_;
  std::vector<Vec3>& normals_;
  std::vector<double>& sizes_;
  long evaluations_ = 0;
};

bool Improver::project(Vec3* point, Vec3* normal, double reach) {
  Vec3 p = *point, gradient;
  for (int i = 0; i < 10; ++i) {
    ++evaluations_;
    const double f = function_(p, &gradient);
    const double slope = gradient.norm();
    if (!std::isfinite(f) || !std::isfinite(slope) || slope <= 0.0) return false;
    gradient /= slope;
    const double distance = f / slope;
    p -= std::clamp(distance, -reach, reach) * gradient;
    // After a step as short as this the next one would be below the tolerance.
    const bool last = distance * distance < options_.tolerance * reach;
    if (!last) continue;
    if ((p - *point).norm() > 2.0 * reach || gradient.dot(*normal) < 0.2) return false;
    *point = p;
    *normal = gradient;
    return true;
  }
  return false;
}

std::vector<bool> Improver::boundary_vertices(const Connectivity& links) const {
  std::vector<bool> boundary(mesh_.vertices.size(), false);
  for (int t = 0; t < mesh_.triangle_count(); ++t)
    for (int e = 0; e < 3; ++e)
      if (links.neighbours[t][e] < 0)
        boundary[mesh_.triangles[t][e]] = boundary[mesh_.triangles[t][(e + 1) % 3]] = true;
  return boundary;
}

// The vertices before and after each boundary vertex along the boundary, -1 for those inside.
std::vector<std::array<int, 2>> Improver::boundary_neighbours(const Connectivity& links) const {
  std::vector<std::array<int, 2>> along(mesh_.vertices.size(), {-1, -1});
  for (int t = 0; t < mesh_.triangle_count(); ++t)
    for (int e = 0; e < 3; ++e)
      if (links.neighbours[t][e] < 0) {
        along[mesh_.triangles[t][e]][1] = mesh_.triangles[t][(e + 1) % 3];
        along[mesh_.triangles[t][(e + 1) % 3]][0] = mesh_.triangles[t][e];
      }
  return along;
}

// Whether triangle (a, b, c) with corners moved to (pa, pb, pc) has area and faces the way of its normals.
bool Improver::upright(int a, int b, int c, const Vec3& pa, const Vec3& pb, const Vec3& pc) const {
  const Vec3 facet = (pb - pa).cross(pc - pa);
  const double area = facet.norm();
  const Vec3 normal = normals_[a] + normals_[b] + normals_[c];
  return area > 0.0 && facet.dot(normal) > 0.3 * area * normal.norm();
}

void Improver::split() {
  const Connectivity links = connectivity(mesh_);
  std::vector<bool> used(mesh_.triangles.size(), false);
  const int count = mesh_.triangle_count();
  for (int t = 0; t < count; ++t)
    for (int e = 0; e < 3; ++e) {
      const int a = mesh_.triangles[t][e], b = mesh_.triangles[t][(e + 1) % 3],
                c = mesh_.triangles[t][(e + 2) % 3];
      const int other = links.neighbours[t][e];
      if (used[t]) break;
      if ((other >= 0 && (other < t || used[other])) || length(a, b) < 4.0 / 3.0 * wanted(a, b)) continue;
      Vec3 p = 0.5 * (at(a) + at(b)), normal = (normals_[a] + normals_[b]).normalized();
      if (!project(&p, &normal, 0.5 * length(a, b))) continue;
      const int m = mesh_.vertex_count();
      used[t] = true;
      mesh_.vertices.push_back(p);
      normals_.push_back(normal);
      sizes_.push_back(wanted(a, b));
      mesh_.triangles[t] = {a, m, c};
      mesh_.triangles.push_back({m, b, c});
      if (other >= 0) {
        used[other] = true;
        const Triangle& far = mesh_.triangles[other];
        const int k = far[0] == b ? 0 : far[1] == b ? 1 : 2;
        const int d = far[(k + 2) % 3];
        mesh_.triangles[other] = {b, m, d};
        mesh_.triangles.push_back({m, a, d});
      }
    }
}

// Whether `from` can be merged into `to`: the mesh stays manifold (link condition), nothing folds or
// stretches.
bool Improver::can_collapse(const Connectivity& links, int from, int to) const {
  std::vector<int> ring_from, ring_to;
  const auto ring = [&](int v, std::vector<int>* out) {
    for (int i = links.vertex_offsets[v]; i < links.vertex_offsets[v + 1]; ++i)
      for (int w : mesh_.triangles[links.vertex_triangles[i]])
        if (w != v) out->push_back(w);
    std::sort(out->begin(), out->end());
    out->erase(std::unique(out->begin(), out->end()), out->end());
  };
  ring(from, &ring_from), ring(to, &ring_to);
  std::vector<int> shared;
  std::set_intersection(ring_from.begin(), ring_from.end(), ring_to.begin(), ring_to.end(),
                        std::back_inserter(shared));
  int wings = 0;
  for (int i = links.vertex_offsets[from]; i < links.vertex_offsets[from + 1]; ++i) {
    const Triangle& t = mesh_.triangles[links.vertex_triangles[i]];
    if (t[0] == to || t[1] == to || t[2] == to) {
      ++wings;
      continue;
    }
    Vec3 p[3];
    for (int k = 0; k < 3; ++k)
      p[k] = at(t[k] == from ? to : t[k]);
    if (!upright(t[0] == from ? to : t[0], t[1] == from ? to : t[1], t[2] == from ? to : t[2], p[0], p[1],
                 p[2]))
      return false;
    if (smallest_angle(p[0], p[1], p[2]) < 0.15) return false;
  }
  if (static_cast<int>(shared.size()) != wings || ring_from.size() < 3 || wings == 0) return false;
  for (int w : ring_from)
    if (w != to && length(w, to) > 1.6 * wanted(w, to)) return false;
  return true;
}

void Improver::collapse() {
  const Connectivity links = connectivity(mesh_);
  const std::vector<bool> boundary = boundary_vertices(links);
  std::vector<bool> touched(mesh_.vertices.size(), false);
  std::vector<int> merged(mesh_.vertices.size());
  for (size_t v = 0; v < merged.size(); ++v)
    merged[v] = static_cast<int>(v);
  const auto ring_untouched = [&](int v) {
    for (int i = links.vertex_offsets[v]; i < links.vertex_offsets[v + 1]; ++i)
      for (int w : mesh_.triangles[links.vertex_triangles[i]])
        if (touched[w]) return false;
    return true;
  };
  const auto valence = [&](int v) { return links.vertex_offsets[v + 1] - links.vertex_offsets[v]; };
  for (int t = 0; t < mesh_.triangle_count(); ++t)
    for (int e = 0; e < 3; ++e) {
      int a = mesh_.triangles[t][e], b = mesh_.triangles[t][(e + 1) % 3];
      const bool border_edge = links.neighbours[t][e] < 0;
      // A vertex of three or four triangles spoils their angles whatever the lengths.
      const bool poor = (valence(a) <= 4 && !boundary[a]) || (valence(b) <= 4 && !boundary[b]);
      if (length(a, b) > (poor ? 0.95 : 2.0 / 3.0) * wanted(a, b)) continue;
      if (boundary[a] || (!boundary[b] && valence(b) < valence(a))) std::swap(a, b);
      if (boundary[a] && !(border_edge && boundary[b])) continue;
      if (normals_[a].dot(normals_[b]) < std::cos(options_.feature_turn)) continue;
      if (!ring_untouched(a) || !ring_untouched(b) || !can_collapse(links, a, b)) continue;
      merged[a] = b;
      for (int v : {a, b})
        for (int i = links.vertex_offsets[v]; i < links.vertex_offsets[v + 1]; ++i)
          for (int w : mesh_.triangles[links.vertex_triangles[i]])
            touched[w] = true;
      break;
    }
  TriangleMesh kept;
  std::vector<int> index(merged.size(), -1);
  std::vector<Triangle> triangles;
  for (const Triangle& t : mesh_.triangles) {
    const Triangle m = {merged[t[0]], merged[t[1]], merged[t[2]]};
    if (m[0] != m[1] && m[1] != m[2] && m[2] != m[0]) triangles.push_back(m);
  }
  int count = 0;
  for (size_t v = 0; v < merged.size(); ++v) {
    if (merged[v] != static_cast<int>(v)) continue;
    index[v] = count;
    mesh_.vertices[count] = mesh_.vertices[v];
    normals_[count] = normals_[v];
    sizes_[count++] = sizes_[v];
  }
  mesh_.vertices.resize(count);
  normals_.resize(count);
  sizes_.resize(count);
  for (Triangle& t : triangles)
    for (int& v : t)
      v = index[v];
  mesh_.triangles = std::move(triangles);
}

// Flips edge `e` of triangle `t` when that makes the smallest of the six angles larger.
bool Improver::flip_edge(Connectivity* links, std::unordered_set<uint64_t>* edges, int t, int e) {
  const int other = links->neighbours[t][e];
  if (other < 0) return false;
  const Triangle near = mesh_.triangles[t], far = mesh_.triangles[other];
  const int a = near[e], b = near[(e + 1) % 3], c = near[(e + 2) % 3];
  const int k = far[0] == b ? 0 : far[1] == b ? 1 : 2;
  const int d = far[(k + 2) % 3];
  if (c == d) return false;
  const double before = std::min(smallest_angle(at(a), at(b), at(c)), smallest_angle(at(b), at(a), at(d)));
  if (before > 0.95) return false;
  const double after = std::min(smallest_angle(at(a), at(d), at(c)), smallest_angle(at(d), at(b), at(c)));
  if (after < before + 1e-3) return false;
  if (!upright(a, d, c, at(a), at(d), at(c)) || !upright(d, b, c, at(d), at(b), at(c))) return false;
  if (normals_[c].dot(normals_[d]) < std::cos(options_.feature_turn) || edges->count(edge_key(c, d)))
    return false;

  const int ad = links->neighbours[other][(k + 1) % 3], db = links->neighbours[other][(k + 2) % 3];
  const int bc = links->neighbours[t][(e + 1) % 3], ca = links->neighbours[t][(e + 2) % 3];
  mesh_.triangles[t] = {a, d, c};
  mesh_.triangles[other] = {d, b, c};
  links->neighbours[t] = {ad, other, ca};
  links->neighbours[other] = {db, bc, t};
  const auto repoint = [&](int triangle, int from_vertex, int to) {
    if (triangle < 0) return;
    for (int i = 0; i < 3; ++i)
      if (mesh_.triangles[triangle][i] == from_vertex) links->neighbours[triangle][i] = to;
  };
  repoint(ad, d, t);  // across, the edge runs d -> a
  repoint(bc, c, other);
  edges->erase(edge_key(a, b));
  edges->insert(edge_key(c, d));
  return true;
}

void Improver::flip() {
  Connectivity links = connectivity(mesh_);
  std::unordered_set<uint64_t> edges;
  edges.reserve(mesh_.triangles.size() * 2);
  for (const Triangle& t : mesh_.triangles)
    for (int e = 0; e < 3; ++e)
      edges.insert(edge_key(t[e], t[(e + 1) % 3]));
  bool flipped = true;
  for (int round = 0; flipped && round < 5; ++round) {
    flipped = false;
    for (int t = 0; t < mesh_.triangle_count(); ++t)
      for (int e = 0; e < 3; ++e)
        flipped |= flip_edge(&links, &edges, t, e);
  }
}

// Height and normal of the surface `step` away from vertex `v`, from the turn of the normals around it.
void Improver::follow_curvature(const Connectivity& links, int v, const Vec3& step, Vec3* point,
                                Vec3* normal) const {
  const Vec3 n = normals_[v], x = n.unitOrthogonal(), y = n.cross(x);
  Eigen::Matrix2d moment = Eigen::Matrix2d::Zero(), turn = Eigen::Matrix2d::Zero();
  for (int i = links.vertex_offsets[v]; i < links.vertex_offsets[v + 1]; ++i)
    for (int w : mesh_.triangles[links.vertex_triangles[i]]) {
      if (w == v) continue;
      const Vec3 along = at(w) - at(v), change = normals_[w] - n;
      const Vec2 d(along.dot(x), along.dot(y)), dn(change.dot(x), change.dot(y));
      moment += d * d.transpose();
      turn += dn * d.transpose();
    }
  const double spread = moment.trace();
  const Vec2 s(step.dot(x), step.dot(y));
  Vec2 tilt = Vec2::Zero();
  if (std::abs(moment.determinant()) > 1e-6 * spread * spread) tilt = turn * moment.inverse() * s;
  *point = at(v) + step - 0.5 * s.dot(tilt) * n;
  *normal = (n + tilt[0] * x + tilt[1] * y).normalized();
}

void Improver::smooth(bool exact) {
  const Connectivity links = connectivity(mesh_);
  const std::vector<bool> boundary = boundary_vertices(links);
  const auto along = boundary_neighbours(links);
  for (int v = 0; v < mesh_.vertex_count(); ++v) {
    Vec3 target = Vec3::Zero();
    if (boundary[v]) {
      if (!options_.move_boundary || along[v][0] < 0 || along[v][1] < 0) continue;
      const Vec3 chord = at(along[v][1]) - at(along[v][0]);
      const Vec3 middle = 0.5 * (at(along[v][1]) + at(along[v][0])) - at(v);
      // Along the boundary freely, across it little: corners of the boundary stay where they are.
      const double slide = middle.dot(chord) / std::max(chord.squaredNorm(), 1e-300);
      target = at(v) + slide * chord + options_.boundary_smoothing * (middle - slide * chord);
    } else {
      double weight = 0.0;
      for (int i = links.vertex_offsets[v]; i < links.vertex_offsets[v + 1]; ++i) {
        const Triangle& t = mesh_.triangles[links.vertex_triangles[i]];
        const double size = sizes_[t[0]] + sizes_[t[1]] + sizes_[t[2]];
        const double area = triangle_area(mesh_, links.vertex_triangles[i]) / (size * size);
        target += area * (at(t[0]) + at(t[1]) + at(t[2])) / 3.0;
        weight += area;
      }
      if (!(weight > 0.0)) continue;
      target /= weight;
    }
    Vec3 step = target - at(v);
    step -= normals_[v] * normals_[v].dot(step);
    const double limit = 0.5 * sizes_[v];
    if (step.norm() > limit) step *= limit / step.norm();
    Vec3 point = at(v), normal = normals_[v];
    follow_curvature(links, v, step, &point, &normal);
    if (!fits(links, v, point)) continue;
    if (exact && (!project(&point, &normal, 0.5 * sizes_[v]) || !fits(links, v, point))) continue;
    mesh_.vertices[v] = point;
    normals_[v] = normal;
  }
}

void Improver::settle() {
  const Connectivity links = connectivity(mesh_);
  for (int v = 0; v < mesh_.vertex_count(); ++v) {
    Vec3 point = at(v), normal = normals_[v];
    if (!project(&point, &normal, 0.5 * sizes_[v])) continue;
    mesh_.vertices[v] = point;
    normals_[v] = normal;
  }
}

// Moves vertices of the worst triangles to wherever nearby the smallest angle around them is largest.
void Improver::relax_worst(double below) {
  const Connectivity links = connectivity(mesh_);
  const std::vector<bool> boundary = boundary_vertices(links);
  const auto worst_around = [&](int v, const Vec3& point) {
    double worst = 4.0;
    for (int i = links.vertex_offsets[v]; i < links.vertex_offsets[v + 1]; ++i) {
      const Triangle& t = mesh_.triangles[links.vertex_triangles[i]];
      Vec3 p[3];
      for (int k = 0; k < 3; ++k)
        p[k] = t[k] == v ? point : at(t[k]);
      if (!upright(t[0], t[1], t[2], p[0], p[1], p[2])) return -1.0;
      worst = std::min(worst, smallest_angle(p[0], p[1], p[2]));
    }
    return worst;
  };
  const auto along = boundary_neighbours(links);
  for (int round = 0; round < 6; ++round) {
    std::vector<bool> poor(mesh_.vertices.size(), false);
    bool any = false;
    for (const Triangle& t : mesh_.triangles)
      if (smallest_angle(at(t[0]), at(t[1]), at(t[2])) < below)
        poor[t[0]] = poor[t[1]] = poor[t[2]] = any = true;
    if (!any) return;
    for (int v = 0; v < mesh_.vertex_count(); ++v) {
      if (!poor[v] || (boundary[v] && (!options_.move_boundary || along[v][0] < 0 || along[v][1] < 0)))
        continue;
      Vec3 x = normals_[v].unitOrthogonal(), y = normals_[v].cross(x);
      if (boundary[v]) {
        // Along the boundary freely, across it only a little.
        const Vec3 chord = at(along[v][1]) - at(along[v][0]);
        x = chord - normals_[v] * normals_[v].dot(chord);
        if (!(x.norm() > 0.0)) continue;
        x.normalize();
        y = options_.boundary_smoothing * normals_[v].cross(x);
      }
      double best = worst_around(v, at(v));
      Vec3 best_point = at(v), best_normal = normals_[v];
      for (double length : {0.06, 0.15, 0.3})
        for (int k = 0; k < 8; ++k) {
          const Vec3 step =
              length * sizes_[v] * (std::cos(k * M_PI / 4.0) * x + std::sin(k * M_PI / 4.0) * y);
          Vec3 point, normal;
          follow_curvature(links, v, step, &point, &normal);
          const double worst = worst_around(v, point);
          if (worst > best + 1e-3) best = worst, best_point = point, best_normal = normal;
        }
      mesh_.vertices[v] = best_point;
      normals_[v] = best_normal;
    }
  }
}

// Whether vertex `v` can move to `point` without turning over or flattening a triangle that was sound.
bool Improver::fits(const Connectivity& links, int v, const Vec3& point) const {
  double before = 4.0, after = 4.0;
  for (int i = links.vertex_offsets[v]; i < links.vertex_offsets[v + 1]; ++i) {
    const Triangle& t = mesh_.triangles[links.vertex_triangles[i]];
    Vec3 p[3];
    for (int k = 0; k < 3; ++k)
      p[k] = t[k] == v ? point : at(t[k]);
    before = std::min(before, smallest_angle(at(t[0]), at(t[1]), at(t[2])));
    after = std::min(after, smallest_angle(p[0], p[1], p[2]));
    if (!upright(t[0], t[1], t[2], p[0], p[1], p[2]) &&
        upright(t[0], t[1], t[2], at(t[0]), at(t[1]), at(t[2])))
      return false;
  }
  return after > before || after > 0.55;
}

}  // namespace

long improve(const smas::ImplicitFunction& function, const smas::QualityOptions& options, TriangleMesh* mesh,
             std::vector<Vec3>* normals, std::vector<double>* sizes) {
  Improver improver(function, options, mesh, normals, sizes);
  for (int pass = 0; pass < options.passes; ++pass) {
    improver.split();
    improver.collapse();
    improver.flip();
    improver.smooth(false);
    improver.smooth(false);
  }
  improver.flip();
  improver.relax_worst(0.6);
  improver.settle();
  improver.flip();
  return improver.evaluations();
}

}  // namespace fascia::skull_maker
