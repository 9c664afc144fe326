#include "builder/smas/relax.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "builder/smas/triangle_shape.h"

namespace fascia::smas {

namespace {

// The surface around a vertex as the turn of the normals around it foretells it.
class LocalSurface {
 public:
  LocalSurface(const SurfaceMesh& m, int v)
      : at_(m.points[v]), n_(m.normals[v]), x_(n_.unitOrthogonal()), y_(n_.cross(x_)) {
    Eigen::Matrix2d moment = Eigen::Matrix2d::Zero(), turn = Eigen::Matrix2d::Zero();
    const auto add = [&](int w) {
      const Vec3 along = m.points[w] - at_, change = m.normals[w] - n_;
      const Vec2 d(along.dot(x_), along.dot(y_)), dn(change.dot(x_), change.dot(y_));
      moment += d * d.transpose();
      turn += dn * d.transpose();
    };
    m.around(v, [&](int h) { add(m.to(h)); });
    if (m.on_boundary(v)) add(m.before_on_boundary(v));
    const double spread = moment.trace();
    bend_.setZero();
    if (std::abs(moment.determinant()) > 1e-6 * spread * spread) bend_ = turn * moment.inverse();
  }

  // Place and normal a tangential `step` away.
  void follow(const Vec3& step, Vec3* point, Vec3* normal) const {
    const Vec2 s(step.dot(x_), step.dot(y_)), tilt = bend_ * s;
    *point = at_ + step - 0.5 * s.dot(tilt) * n_;
    *normal = (n_ + tilt[0] * x_ + tilt[1] * y_).normalized();
  }
  const Vec3& x() const { return x_; }
  const Vec3& y() const { return y_; }

 private:
  Vec3 at_, n_, x_, y_;
  Eigen::Matrix2d bend_;
};

// Cosine of the smallest angle around `v` if it were at `point`; 2 when a triangle turns over.
double worst_around(const SurfaceMesh& m, int v, const Vec3& point) {
  double worst = -1.0;
  m.around(v, [&](int h) {
    const int a = m.to(h), b = m.apex(h);
    const Vec3 facing = m.normals[v] + m.normals[a] + m.normals[b];
    const double cosine = is_upright(point, m.points[a], m.points[b], facing)
                              ? smallest_angle_cosine(point, m.points[a], m.points[b])
                              : 2.0;
    worst = std::max(worst, cosine);
  });
  return worst;
}

// Where smoothing takes a vertex.
Vec3 centre_of_boundary(const SurfaceMesh& m, const BoundaryMotion& boundary, int v) {
  const Vec3 &ahead = m.points[m.after_on_boundary(v)], &behind = m.points[m.before_on_boundary(v)];
  const Vec3 chord = ahead - behind, middle = 0.5 * (ahead + behind) - m.points[v];
  // Along the boundary freely, across it little: corners of the boundary stay where they are.
  const double slide = middle.dot(chord) / std::max(chord.squaredNorm(), 1e-300);
  return m.points[v] + slide * chord + boundary.across * (middle - slide * chord);
}

Vec3 centre_of_ring(const SurfaceMesh& m, int v) {
  Vec3 sum = Vec3::Zero();
  double weight = 0.0;
  m.around(v, [&](int h) {
    const int a = m.to(h), b = m.apex(h);
    const Vec3 u = m.points[a] - m.points[v], w = m.points[b] - m.points[v];
    const double size = m.sizes[v] + m.sizes[a] + m.sizes[b];
    const double area = u.cross(w).norm() / (size * size);
    sum += area * (u + w);
    weight += area;
  });
  return weight > 0.0 ? Vec3(m.points[v] + sum / (3.0 * weight)) : m.points[v];
}

bool may_move(const SurfaceMesh& m, const BoundaryMotion& boundary, int v) {
  return m.leaving[v] >= 0 && !m.fixed[v] && (boundary.along || !m.on_boundary(v));
}

}  // namespace

void smooth_along_surface(const BoundaryMotion& boundary, SurfaceMesh* mesh) {
  SurfaceMesh& m = *mesh;
  const double good = std::cos(0.55);
  for (int v = 0; v < static_cast<int>(m.points.size()); ++v) {
    if (!may_move(m, boundary, v)) continue;
    Vec3 step = (m.on_boundary(v) ? centre_of_boundary(m, boundary, v) : centre_of_ring(m, v)) - m.points[v];
    step -= m.normals[v] * m.normals[v].dot(step);
    const double limit = 0.5 * m.sizes[v], length = step.norm();
    if (length < 1e-3 * m.sizes[v]) continue;
    if (length > limit) step *= limit / length;
    Vec3 point, normal;
    LocalSurface(m, v).follow(step, &point, &normal);
    const double after = worst_around(m, v, point);
    if (after < good || after < worst_around(m, v, m.points[v])) m.points[v] = point, m.normals[v] = normal;
  }
}

namespace {

// A place to which a vertex could move, and the worst angle's cosine there.
struct Place {
  double worst;
  Vec3 point, normal;
};

// Where vertex `v` might go, the best first, as far as it is better than where it is.
void better_places(const SurfaceMesh& m, const BoundaryMotion& boundary, bool off_surface, int v,
                   std::vector<Place>* places) {
  places->clear();
  const LocalSurface local(m, v);
  Vec3 x = local.x(), y = local.y();
  if (m.on_boundary(v)) {
    // Along the boundary freely, across it only a little.
    const Vec3 chord = m.points[m.after_on_boundary(v)] - m.points[m.before_on_boundary(v)];
    x = chord - m.normals[v] * m.normals[v].dot(chord);
    if (!(x.norm() > 0.0)) return;
    x.normalize();
    y = boundary.across * m.normals[v].cross(x);
  }
  const double now = worst_around(m, v, m.points[v]);
  const auto consider = [&](const Vec3& point, const Vec3& normal) {
    const double worst = worst_around(m, v, point);
    if (worst < now - 1e-3) places->push_back({worst, point, normal});
  };
  for (double length : {0.06, 0.15, 0.3})
    for (int k = 0; k < 8; ++k) {
      Vec3 point, normal;
      local.follow(length * m.sizes[v] * (std::cos(k * M_PI / 4.0) * x + std::sin(k * M_PI / 4.0) * y),
                   &point, &normal);
      consider(point, normal);
    }
  if (off_surface && !m.on_boundary(v)) {
    const Vec3 centre = centre_of_ring(m, v);
    for (double share : {0.5, 1.0})
      consider(m.points[v] + share * (centre - m.points[v]), m.normals[v]);
  }
  std::stable_sort(places->begin(), places->end(),
                   [](const Place& a, const Place& b) { return a.worst < b.worst; });
}

}  // namespace

bool relax_worst(const BoundaryMotion& boundary, double least_angle,
                 const std::function<bool(int, const Vec3&)>& may_lie, SurfaceMesh* mesh) {
  SurfaceMesh& m = *mesh;
  const double limit = std::cos(least_angle);
  bool any = false;
  std::vector<Place> places;
  for (int round = 0; round < 6; ++round) {
    std::vector<char> poor(m.points.size(), 0);
    bool moved = false;
    for (const Triangle& t : m.triangles) {
      const Vec3 &a = m.points[t[0]], &b = m.points[t[1]], &c = m.points[t[2]];
      if (smallest_angle_cosine(a, b, c) > limit ||
          !is_upright(a, b, c, m.normals[t[0]] + m.normals[t[1]] + m.normals[t[2]]))
        poor[t[0]] = poor[t[1]] = poor[t[2]] = 1;
    }
    for (int v = 0; v < static_cast<int>(m.points.size()); ++v) {
      if (!poor[v] || !may_move(m, boundary, v)) continue;
      better_places(m, boundary, static_cast<bool>(may_lie), v, &places);
      for (const Place& place : places) {
        if (may_lie && !may_lie(v, place.point)) continue;
        m.points[v] = place.point;
        m.normals[v] = place.normal;
        moved = any = true;
        break;
      }
    }
    if (!moved) break;
  }
  return any;
}

void settle(SurfaceField* field, SurfaceMesh* mesh) {
  for (size_t v = 0; v < mesh->points.size(); ++v)
    field->project(&mesh->points[v], &mesh->normals[v], 0.5 * mesh->sizes[v]);
}

}  // namespace fascia::smas
