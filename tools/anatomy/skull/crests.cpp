#include "tools/anatomy/skull/crests.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

#include "tools/anatomy/skull/half_mesh.h"

namespace fascia::skull_maker {
namespace {

double smallest_angle(const Vec3& a, const Vec3& b, const Vec3& c) {
  const auto at = [](const Vec3& corner, const Vec3& p, const Vec3& q) {
    return std::atan2((p - corner).cross(q - corner).norm(), (p - corner).dot(q - corner));
  };
  return std::min({at(a, b, c), at(b, c, a), at(c, a, b)});
}

struct Creaser {
  const smas::ImplicitFunction& field;
  const std::vector<double>& sizes;
  double rim_angle;
  double least_angle;
  TriangleMesh& mesh;
  std::vector<std::vector<int>> fans;
  std::vector<bool> held;
  std::vector<Vec3> normals;  ///< of the surface at the vertices

  Vec3& at(int v) { return mesh.vertices[static_cast<std::size_t>(v)]; }
  Triangle& triangle(int t) { return mesh.triangles[static_cast<std::size_t>(t)]; }
  std::vector<int>& fan(int v) { return fans[static_cast<std::size_t>(v)]; }
  bool beside_rim(int v) {
    return std::any_of(fan(v).begin(), fan(v).end(), [&](int t) {
      return std::any_of(triangle(t).begin(), triangle(t).end(),
                         [&](int w) { return held[static_cast<std::size_t>(w)]; });
    });
  }
  double allowed_angle(int v) { return beside_rim(v) ? rim_angle : least_angle; }
  bool fixed(int v) { return held[static_cast<std::size_t>(v)] || at(v).x() == 0; }

  /// Distance to the surface, to first order; `normal` of the surface there.
  double off_surface(const Vec3& point, Vec3* normal = nullptr) const {
    Vec3 gradient = Vec3::Zero();
    const double value = field(point, &gradient);
    const double length = gradient.norm();
    if (!std::isfinite(value) || !std::isfinite(length) || length < 1e-3) return 1e3;
    if (normal) *normal = gradient / length;
    return value / length;
  }

  void update_normal(int v) {
    Vec3 normal;
    if (off_surface(at(v), &normal) < 1e3) normals[static_cast<std::size_t>(v)] = normal;
  }

  /// Is a triangle neither a sliver nor turned over against the surface?
  bool sound(const Triangle& t, double angle) {
    const Vec3 area = (at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0]));
    Vec3 surface = Vec3::Zero();
    for (const int v : t)
      surface += normals[static_cast<std::size_t>(v)];
    return area.dot(surface) > 0.25 * area.norm() * surface.norm() &&
           smallest_angle(at(t[0]), at(t[1]), at(t[2])) > angle;
  }

  bool all_sound(int v, double angle) {
    return std::all_of(fan(v).begin(), fan(v).end(), [&](int t) { return sound(triangle(t), angle); });
  }

  double worst_angle(int v) {
    double worst = std::numbers::pi;
    for (const int t : fan(v))
      worst = std::min(worst, smallest_angle(at(triangle(t)[0]), at(triangle(t)[1]), at(triangle(t)[2])));
    return worst;
  }

  /// Moves a vertex unless that spoils a triangle: makes an angle below `angle` that was not.
  bool move(int v, const Vec3& to, double angle) {
    const Vec3 from = at(v);
    const Vec3 normal = normals[static_cast<std::size_t>(v)];
    const double allowed = std::min(angle, worst_angle(v));
    at(v) = to;
    update_normal(v);
    if (to.allFinite() && all_sound(v, 0.999 * allowed)) return true;
    at(v) = from;
    normals[static_cast<std::size_t>(v)] = normal;
    return false;
  }

  void hold_on(const Rim& rim);
  bool flip(int a, int b);
  int flip_all();
  void move_to_planes();
};

/// Vertices next to the rim go onto it, nearest first, no two closer than half an edge.
void Creaser::hold_on(const Rim& rim) {
  std::vector<std::tuple<double, int, Vec3>> near;
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    if (fixed(v)) continue;
    double best = 0.3 * sizes[static_cast<std::size_t>(v)] * sizes[static_cast<std::size_t>(v)];
    Vec3 foot;
    bool found = false;
    for (std::size_t i = 0; i + 1 < rim.size(); ++i) {
      const Vec3 along = rim[i + 1] - rim[i];
      const double t = std::clamp((at(v) - rim[i]).dot(along) / along.squaredNorm(), 0.0, 1.0);
      const Vec3 point = rim[i] + t * along;
      if ((at(v) - point).squaredNorm() < best) {
        best = (at(v) - point).squaredNorm();
        foot = point;
        found = true;
      }
    }
    if (found) near.emplace_back(best, v, foot);
  }
  std::sort(near.begin(), near.end(), [](const auto& a, const auto& b) {
    return std::pair(std::get<0>(a), std::get<1>(a)) < std::pair(std::get<0>(b), std::get<1>(b));
  });
  std::vector<Vec3> taken;
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    if (held[static_cast<std::size_t>(v)]) taken.push_back(at(v));
  }
  for (const auto& [distance, v, foot] : near) {
    const double apart = 0.5 * sizes[static_cast<std::size_t>(v)];
    const Vec3 goal = on_surface(field, foot, false);
    if (std::any_of(taken.begin(), taken.end(), [&](const Vec3& p) { return (p - goal).norm() < apart; }))
      continue;
    if (!move(v, goal, rim_angle)) continue;
    held[static_cast<std::size_t>(v)] = true;
    taken.push_back(goal);
  }
}

/// Turns edge ab to the other diagonal when that lies closer to the surface.
bool Creaser::flip(int a, int b) {
  std::vector<int> sides;
  for (const int t : fan(a)) {
    if (std::count(triangle(t).begin(), triangle(t).end(), b) > 0) sides.push_back(t);
  }
  if (sides.size() != 2) return false;
  const auto apex = [&](int t) {
    for (const int v : triangle(t)) {
      if (v != a && v != b) return v;
    }
    return -1;
  };
  const int c = apex(sides[0]);
  const int d = apex(sides[1]);
  for (const int t : fan(c)) {
    if (std::count(triangle(t).begin(), triangle(t).end(), d) > 0) return false;
  }
  // Both ends in the midplane would make an edge that the mirror image shares.
  if (at(c).x() == 0 && at(d).x() == 0) return false;
  if (fan(a).size() < 5 || fan(b).size() < 5) return false;
  // Along a held rim the edge stays.
  const auto on_rim = [&](int v) { return static_cast<bool>(held[static_cast<std::size_t>(v)]); };
  const double before = std::abs(off_surface(0.5 * (at(a) + at(b))));
  const double after = std::abs(off_surface(0.5 * (at(c) + at(d))));
  const bool towards_rim = on_rim(c) && on_rim(d) && !(on_rim(a) && on_rim(b));
  if (!(after < 0.8 * before - 0.01 || (towards_rim && after < before + 0.02))) return false;
  const auto follows = [&](int t, int from, int to) {
    for (std::size_t k = 0; k < 3; ++k) {
      if (triangle(t)[k] == from && triangle(t)[(k + 1) % 3] == to) return true;
    }
    return false;
  };
  const int first = follows(sides[0], a, b) ? sides[0] : sides[1];
  const int second = first == sides[0] ? sides[1] : sides[0];
  const int left = apex(first);    // first is a b left
  const int right = apex(second);  // second is b a right
  const Triangle one{a, right, left};
  const Triangle two{right, b, left};
  const double worst = std::min(smallest_angle(at(a), at(b), at(c)), smallest_angle(at(a), at(b), at(d)));
  const double allowed = std::min(std::min(allowed_angle(a), allowed_angle(b)), worst);
  if (!sound(one, allowed) || !sound(two, allowed)) return false;
  triangle(first) = one;
  triangle(second) = two;
  std::erase(fan(b), first);
  std::erase(fan(a), second);
  fan(right).push_back(first);
  fan(left).push_back(second);
  return true;
}

int Creaser::flip_all() {
  int count = 0;
  for (int t = 0; t < mesh.triangle_count(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const int a = triangle(t)[k];
      const int b = triangle(t)[(k + 1) % 3];
      if (a < b && flip(a, b)) ++count;
    }
  }
  return count;
}

/// Each vertex to the point nearest to the tangent planes of the surface at the triangles around it; where
/// they are all alike, towards the middle of those triangles.
void Creaser::move_to_planes() {
  constexpr double to_middle = 0.12;
  for (int v = 0; v < mesh.vertex_count(); ++v) {
    if (fixed(v)) continue;
    Eigen::Matrix3d planes = Eigen::Matrix3d::Zero();
    Vec3 right_side = Vec3::Zero();
    Vec3 middle = Vec3::Zero();
    double weights = 0;
    for (const int t : fan(v)) {
      const Triangle& corners = triangle(t);
      const Vec3 centre = (at(corners[0]) + at(corners[1]) + at(corners[2])) / 3;
      Vec3 normal;
      const double off = off_surface(centre, &normal);
      if (off >= 1e3) continue;
      const double weight = triangle_area(mesh, t);
      const Vec3 foot = centre - off * normal;
      planes += weight * normal * normal.transpose();
      right_side += weight * normal.dot(foot) * normal;
      middle += weight * centre;
      weights += weight;
    }
    if (weights <= 0) continue;
    planes = planes / weights + to_middle * Eigen::Matrix3d::Identity();
    const Vec3 goal = planes.ldlt().solve(right_side / weights + to_middle * middle / weights);
    const Vec3 step = goal - at(v);
    const double longest = 0.4 * sizes[static_cast<std::size_t>(v)];
    const Vec3 to = at(v) + step * std::min(1.0, longest / std::max(step.norm(), 1e-9));
    if (to.x() > 0.05) move(v, on_surface(field, to, false), allowed_angle(v));
  }
}

}  // namespace

void follow_creases(const smas::ImplicitFunction& field, const std::vector<Rim>& rims,
                    const std::vector<double>& sizes, const CreaseOptions& options, TriangleMesh* half) {
  const std::size_t count = half->vertices.size();
  constexpr double degree = std::numbers::pi / 180;
  Creaser work{field,
               sizes,
               options.rim_angle * degree,
               options.least_angle * degree,
               *half,
               std::vector<std::vector<int>>(count),
               std::vector<bool>(count, false),
               std::vector<Vec3>(count, Vec3::UnitY())};
  for (int t = 0; t < half->triangle_count(); ++t) {
    for (const int v : work.triangle(t))
      work.fan(v).push_back(t);
  }
  for (int v = 0; v < half->vertex_count(); ++v)
    work.update_normal(v);
  for (int pass = 0; pass < options.passes; ++pass) {
    if (pass % 2 == 0) {
      for (const Rim& rim : rims)
        work.hold_on(rim);
    }
    work.flip_all();
    work.move_to_planes();
  }
  work.flip_all();
}

}  // namespace fascia::skull_maker
