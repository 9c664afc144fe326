#include "tools/anatomy/skull/improve.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "builder/smas/relax.h"
#include "builder/smas/surface_edits.h"
#include "builder/smas/surface_mesh.h"
#include "builder/smas/triangle_shape.h"

namespace fascia::skull_maker {

namespace {

double angle_at(const Vec3& a, const Vec3& b, const Vec3& c) {
  return std::atan2((b - a).cross(c - a).norm(), (b - a).dot(c - a));
}

double smallest_angle(const Vec3& a, const Vec3& b, const Vec3& c) {
  return std::min({angle_at(a, b, c), angle_at(b, c, a), angle_at(c, a, b)});
}

class Improver {
 public:
  Improver(const smas::ImplicitFunction& function, const smas::QualityOptions& options,
           smas::SurfaceMesh& mesh)
      : field_{function, options.tolerance}, options_(options), mesh_(mesh) {}

  void split() { smas::split_long_edges(&field_, &mesh_); }
  void collapse();
  void flip();
  void smooth();
  void relax_worst(double below);
  void settle() { smas::settle(&field_, &mesh_); }
  long evaluations() const { return field_.evaluations; }

 private:
  const Vec3& at(int v) const { return mesh_.points[v]; }
  int vertex_count() const { return static_cast<int>(mesh_.points.size()); }
  double length(int a, int b) const { return (at(a) - at(b)).norm(); }
  double wanted(int a, int b) const { return 0.5 * (mesh_.sizes[a] + mesh_.sizes[b]); }
  Vec3 facing(int a, int b, int c) const { return mesh_.normals[a] + mesh_.normals[b] + mesh_.normals[c]; }
  bool upright(int a, int b, int c, const Vec3& pa, const Vec3& pb, const Vec3& pc) const {
    return smas::is_upright(pa, pb, pc, facing(a, b, c));
  }
  bool may_move(int v) const { return !mesh_.on_boundary(v) || options_.move_boundary; }
  bool can_collapse(int from, int to) const;
  bool fits(int v, const Vec3& point) const;
  bool flip_if_better(int h);
  Vec3 centre_of(int v) const;
  void follow_curvature(int v, const Vec3& step, Vec3* point, Vec3* normal) const;

  smas::SurfaceField field_;
  const smas::QualityOptions& options_;
  smas::SurfaceMesh& mesh_;
};

// Whether `from` can be merged into `to`: the mesh stays manifold (link condition), nothing folds or
// stretches.
bool Improver::can_collapse(int from, int to) const {
  std::vector<int> ring_from, ring_to, shared;
  mesh_.ring(from, ring_from), mesh_.ring(to, ring_to);
  std::set_intersection(ring_from.begin(), ring_from.end(), ring_to.begin(), ring_to.end(),
                        std::back_inserter(shared));
  size_t wings = 0;
  bool sound = true;
  mesh_.around(from, [&](int h) {
    const int b = mesh_.to(h), c = mesh_.apex(h);
    if (b == to || c == to) {
      ++wings;
      return;
    }
    sound = sound && upright(to, b, c, at(to), at(b), at(c)) && smallest_angle(at(to), at(b), at(c)) >= 0.15;
  });
  if (!sound || shared.size() != wings || ring_from.size() < 3 || wings == 0) return false;
  return std::all_of(ring_from.begin(), ring_from.end(),
                     [&](int w) { return w == to || length(w, to) <= 1.6 * wanted(w, to); });
}

// A pass never merges twice in one neighbourhood, so that it decides on the mesh as it was.
void Improver::collapse() {
  std::vector<bool> touched(mesh_.points.size(), false);
  std::vector<int> ring;
  const auto is_touched = [&](int v) {
    mesh_.ring(v, ring);
    return touched[v] || std::any_of(ring.begin(), ring.end(), [&](int w) { return touched[w]; });
  };
  const auto touch = [&](int v) {
    mesh_.ring(v, ring);
    touched[v] = true;
    for (const int w : ring)
      touched[w] = true;
  };
  for (int h = 0; h < static_cast<int>(mesh_.twin.size()); ++h) {
    if (mesh_.gone(h)) continue;
    int a = mesh_.from(h), b = mesh_.to(h);
    const int around_a = mesh_.valence(a), around_b = mesh_.valence(b);
    const bool border_a = mesh_.on_boundary(a), border_b = mesh_.on_boundary(b);
    // A vertex of three or four triangles spoils their angles whatever the lengths.
    const bool poor = (around_a <= 4 && !border_a) || (around_b <= 4 && !border_b);
    if (length(a, b) > (poor ? 0.95 : 2.0 / 3.0) * wanted(a, b)) continue;
    if (border_a || (!border_b && around_b < around_a)) std::swap(a, b);
    if (mesh_.on_boundary(a) && !(mesh_.across(h) < 0 && mesh_.on_boundary(b))) continue;
    if (mesh_.normals[a].dot(mesh_.normals[b]) < std::cos(options_.feature_turn)) continue;
    if (is_touched(a) || is_touched(b) || !mesh_.may_edit(h) || !can_collapse(a, b)) continue;
    touch(a);
    touch(b);
    mesh_.collapse(h, b);
  }
  mesh_.compact();
}

// Flips the edge of `h` when that makes the smallest of the six angles larger.
bool Improver::flip_if_better(int h) {
  const int g = mesh_.across(h);
  if (g < 0) return false;
  const int a = mesh_.from(h), b = mesh_.to(h), c = mesh_.apex(h), d = mesh_.apex(g);
  if (c == d) return false;
  const double before = std::min(smallest_angle(at(a), at(b), at(c)), smallest_angle(at(b), at(a), at(d)));
  if (before > 0.95) return false;
  const double after = std::min(smallest_angle(at(a), at(d), at(c)), smallest_angle(at(d), at(b), at(c)));
  if (after < before + 1e-3) return false;
  if (!upright(a, d, c, at(a), at(d), at(c)) || !upright(d, b, c, at(d), at(b), at(c))) return false;
  if (mesh_.normals[c].dot(mesh_.normals[d]) < std::cos(options_.feature_turn) || !mesh_.may_edit(h) ||
      mesh_.find_either(c, d) >= 0)
    return false;
  mesh_.flip(h);
  return true;
}

void Improver::flip() {
  bool flipped = true;
  for (int round = 0; flipped && round < 5; ++round) {
    flipped = false;
    for (int h = 0; h < static_cast<int>(mesh_.twin.size()); ++h)
      flipped |= flip_if_better(h);
  }
}

// Height and normal of the surface `step` away from vertex `v`, from the turn of the normals around it.
void Improver::follow_curvature(int v, const Vec3& step, Vec3* point, Vec3* normal) const {
  const Vec3 n = mesh_.normals[v], x = n.unitOrthogonal(), y = n.cross(x);
  Eigen::Matrix2d moment = Eigen::Matrix2d::Zero(), turn = Eigen::Matrix2d::Zero();
  mesh_.around(v, [&](int h) {
    for (const int w : {mesh_.to(h), mesh_.apex(h)}) {
      const Vec3 along = at(w) - at(v), change = mesh_.normals[w] - n;
      const Vec2 d(along.dot(x), along.dot(y)), dn(change.dot(x), change.dot(y));
      moment += d * d.transpose();
      turn += dn * d.transpose();
    }
  });
  const double spread = moment.trace();
  const Vec2 s(step.dot(x), step.dot(y));
  Vec2 tilt = Vec2::Zero();
  if (std::abs(moment.determinant()) > 1e-6 * spread * spread) tilt = turn * moment.inverse() * s;
  *point = at(v) + step - 0.5 * s.dot(tilt) * n;
  *normal = (n + tilt[0] * x + tilt[1] * y).normalized();
}

// Where smoothing takes vertex `v`.
Vec3 Improver::centre_of(int v) const {
  if (mesh_.on_boundary(v)) {
    const Vec3 &ahead = at(mesh_.after_on_boundary(v)), &behind = at(mesh_.before_on_boundary(v));
    const Vec3 chord = ahead - behind, middle = 0.5 * (ahead + behind) - at(v);
    // Along the boundary freely, across it little: corners of the boundary stay where they are.
    const double slide = middle.dot(chord) / std::max(chord.squaredNorm(), 1e-300);
    return at(v) + slide * chord + options_.boundary_smoothing * (middle - slide * chord);
  }
  Vec3 sum = Vec3::Zero();
  double weight = 0.0;
  mesh_.around(v, [&](int h) {
    const int b = mesh_.to(h), c = mesh_.apex(h);
    const double size = mesh_.sizes[v] + mesh_.sizes[b] + mesh_.sizes[c];
    const double area = 0.5 * (at(b) - at(v)).cross(at(c) - at(v)).norm() / (size * size);
    sum += area * (at(v) + at(b) + at(c)) / 3.0;
    weight += area;
  });
  return weight > 0.0 ? Vec3(sum / weight) : at(v);
}

void Improver::smooth() {
  for (int v = 0; v < vertex_count(); ++v) {
    if (mesh_.leaving[v] < 0 || mesh_.fixed[v] || !may_move(v)) continue;
    Vec3 step = centre_of(v) - at(v);
    step -= mesh_.normals[v] * mesh_.normals[v].dot(step);
    const double limit = 0.5 * mesh_.sizes[v];
    if (step.norm() > limit) step *= limit / step.norm();
    Vec3 point = at(v), normal = mesh_.normals[v];
    follow_curvature(v, step, &point, &normal);
    if (!fits(v, point)) continue;
    mesh_.points[v] = point;
    mesh_.normals[v] = normal;
  }
}

// Moves vertices of the worst triangles to wherever nearby the smallest angle around them is largest.
void Improver::relax_worst(double below) {
  const auto worst_around = [&](int v, const Vec3& point) {
    double worst = 4.0;
    mesh_.around(v, [&](int h) {
      const int b = mesh_.to(h), c = mesh_.apex(h);
      const double angle = upright(v, b, c, point, at(b), at(c)) ? smallest_angle(point, at(b), at(c)) : -1.0;
      worst = std::min(worst, angle);
    });
    return worst;
  };
  for (int round = 0; round < 6; ++round) {
    std::vector<bool> poor(mesh_.points.size(), false);
    bool any = false;
    for (const Triangle& t : mesh_.triangles)
      if (smallest_angle(at(t[0]), at(t[1]), at(t[2])) < below)
        poor[t[0]] = poor[t[1]] = poor[t[2]] = any = true;
    if (!any) return;
    for (int v = 0; v < vertex_count(); ++v) {
      if (!poor[v] || mesh_.leaving[v] < 0 || mesh_.fixed[v] || !may_move(v)) continue;
      const Vec3 n = mesh_.normals[v];
      Vec3 x = n.unitOrthogonal(), y = n.cross(x);
      if (mesh_.on_boundary(v)) {
        // Along the boundary freely, across it only a little.
        const Vec3 chord = at(mesh_.after_on_boundary(v)) - at(mesh_.before_on_boundary(v));
        x = chord - n * n.dot(chord);
        if (!(x.norm() > 0.0)) continue;
        x.normalize();
        y = options_.boundary_smoothing * n.cross(x);
      }
      double best = worst_around(v, at(v));
      Vec3 best_point = at(v), best_normal = n;
      for (double length : {0.06, 0.15, 0.3})
        for (int k = 0; k < 8; ++k) {
          const Vec3 step =
              length * mesh_.sizes[v] * (std::cos(k * M_PI / 4.0) * x + std::sin(k * M_PI / 4.0) * y);
          Vec3 point, normal;
          follow_curvature(v, step, &point, &normal);
          const double worst = worst_around(v, point);
          if (worst > best + 1e-3) best = worst, best_point = point, best_normal = normal;
        }
      mesh_.points[v] = best_point;
      mesh_.normals[v] = best_normal;
    }
  }
}

// Whether vertex `v` can move to `point` without turning over or flattening a triangle that was sound.
bool Improver::fits(int v, const Vec3& point) const {
  double before = 4.0, after = 4.0;
  bool turns = false;
  mesh_.around(v, [&](int h) {
    const int b = mesh_.to(h), c = mesh_.apex(h);
    before = std::min(before, smallest_angle(at(v), at(b), at(c)));
    after = std::min(after, smallest_angle(point, at(b), at(c)));
    turns = turns || (!upright(v, b, c, point, at(b), at(c)) && upright(v, b, c, at(v), at(b), at(c)));
  });
  return !turns && (after > before || after > 0.55);
}

}  // namespace

long improve(const smas::ImplicitFunction& function, const smas::QualityOptions& options, TriangleMesh* mesh,
             std::vector<Vec3>* normals, std::vector<double>* sizes) {
  smas::SurfaceMesh work(*mesh, *normals, *sizes);
  Improver improver(function, options, work);
  for (int pass = 0; pass < options.passes; ++pass) {
    improver.split();
    improver.collapse();
    improver.flip();
    improver.smooth();
    improver.smooth();
  }
  improver.flip();
  improver.relax_worst(0.6);
  improver.settle();
  improver.flip();
  mesh->vertices = std::move(work.points);
  mesh->triangles = std::move(work.triangles);
  *normals = std::move(work.normals);
  *sizes = std::move(work.sizes);
  return improver.evaluations();
}

}  // namespace fascia::skull_maker
