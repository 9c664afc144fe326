#include "builder/skull/exterior.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

#include "geometry/connectivity.h"

namespace fascia::skull {
namespace {

constexpr int ray_count = 16;
constexpr int rays_needed = 4;

// Cosine-weighted directions about +z in two rings, the most upright first so that open triangles decide
// early. The pattern is its own mirror image in x and y: a symmetric head has a symmetric exterior.
std::array<Vec3, ray_count> hemisphere() {
  std::array<Vec3, ray_count> out;
  for (int i = 0; i < ray_count; ++i) {
    const double radius = std::sqrt((i / 8 + 0.5) / 2);
    const double angle = (i % 8 + 0.5) * std::numbers::pi / 4;
    out[i] = Vec3(radius * std::cos(angle), radius * std::sin(angle), std::sqrt(1 - radius * radius));
  }
  return out;
}

// Columns: a tangent as near to up as possible, the other tangent, the normal.
Mat3 frame_about(const Vec3& normal) {
  const Vec3 up = std::abs(normal.y()) < 0.99 ? Vec3::UnitY() : Vec3::UnitZ();
  Mat3 frame;
  frame.col(0) = (up - up.dot(normal) * normal).normalized();
  frame.col(1) = normal.cross(frame.col(0));
  frame.col(2) = normal;
  return frame;
}

// `skin` with vertices closer than `tolerance` at one position; triangles and indices stay.
TriangleMesh snapped(const TriangleMesh& skin, double tolerance) {
  std::vector<int> map;
  const TriangleMesh welded = weld(skin, tolerance, &map);
  TriangleMesh out = skin;
  for (size_t v = 0; v < map.size(); ++v)
    if (map[v] >= 0) out.vertices[v] = welded.vertices[map[v]];
  return out;
}

// The skin with a lid on every opening: light must not come in through the neck.
TriangleMesh lidded(const TriangleMesh& skin) {
  TriangleMesh out = weld(skin, 0, nullptr);
  for (const std::vector<int>& loop : boundary_loops(out, connectivity(out))) {
    Vec3 centre = Vec3::Zero();
    for (int v : loop)
      centre += out.vertices[v] / static_cast<double>(loop.size());
    const int middle = out.vertex_count();
    out.vertices.push_back(centre);
    for (size_t i = 0; i < loop.size(); ++i)
      out.triangles.push_back({loop[(i + 1) % loop.size()], loop[i], middle});
  }
  return out;
}

// Vertices of the long loops along which the skin ends; the slits of lips and lids are shorter.
std::vector<bool> border(const TriangleMesh& skin) {
  constexpr double shortest = 0.2;  // m
  std::vector<int> map;
  const TriangleMesh welded = weld(skin, 0, &map);
  std::vector<bool> on_border(welded.vertices.size(), false);
  for (const std::vector<int>& loop : boundary_loops(welded, connectivity(welded))) {
    double length = 0;
    for (size_t i = 0; i < loop.size(); ++i)
      length += (welded.vertices[loop[i]] - welded.vertices[loop[(i + 1) % loop.size()]]).norm();
    if (length < shortest) continue;
    for (int v : loop)
      on_border[v] = true;
  }
  std::vector<bool> out(skin.vertices.size(), false);
  for (size_t v = 0; v < out.size(); ++v)
    out[v] = map[v] >= 0 && on_border[map[v]];
  return out;
}

// Marks the sides that one triangle alone has, vertices at the same position taken as one.
void mark_rims(const TriangleMesh& mesh, Exterior& out) {
  std::map<std::array<double, 3>, int> places;
  std::vector<int> place(mesh.vertices.size());
  for (size_t v = 0; v < place.size(); ++v) {
    const Vec3& p = mesh.vertices[v];
    place[v] = places.try_emplace({p.x(), p.y(), p.z()}, static_cast<int>(places.size())).first->second;
  }
  std::vector<std::array<int, 4>> sides;  // lower place, higher place, triangle, side
  for (int t = 0; t < mesh.triangle_count(); ++t)
    for (int k = 0; k < 3; ++k) {
      const int a = place[mesh.triangles[t][k]], b = place[mesh.triangles[t][(k + 1) % 3]];
      sides.push_back({std::min(a, b), std::max(a, b), t, k});
    }
  std::sort(sides.begin(), sides.end());
  out.open_sides.assign(mesh.triangles.size(), {false, false, false});
  std::vector<bool> open_place(places.size(), false);
  for (size_t i = 0; i < sides.size(); ++i) {
    const auto same = [&](size_t j) {
      return j < sides.size() && sides[j][0] == sides[i][0] && sides[j][1] == sides[i][1];
    };
    if (same(i + 1) || (i > 0 && same(i - 1))) continue;
    out.open_sides[sides[i][2]][sides[i][3]] = true;
    open_place[sides[i][0]] = open_place[sides[i][1]] = true;
  }
  out.open_vertices.resize(mesh.vertices.size());
  for (size_t v = 0; v < place.size(); ++v)
    out.open_vertices[v] = open_place[place[v]];
}

}  // namespace

bool Exterior::on_rim(const spatial::ClosestPoint& closest) const {
  const Vec3& weights = closest.surface.barycentric;
  const int triangle = closest.surface.triangle;
  const Triangle& corners = surface.mesh().triangles[triangle];
  for (int k = 0; k < 3; ++k) {
    if (weights[k] >= 1 && open_vertices[corners[k]]) return true;
    if (weights[(k + 2) % 3] <= 0 && open_sides[triangle][k]) return true;
  }
  return false;
}

bool Exterior::on_border(const spatial::ClosestPoint& closest) const {
  for (int k = 0; k < 3; ++k)
    if (closest.surface.barycentric[k] > 0 &&
        !border_vertices[surface.mesh().triangles[closest.surface.triangle][k]])
      return false;
  return true;
}

spatial::ClosestPoint Exterior::closest(const Vec3& point, double range) const {
  spatial::ClosestPoint out = surface.closest(point, range);
  if (out.found() && on_rim(out)) out.signed_distance = -out.distance;
  return out;
}

Exterior exterior(const TriangleMesh& unwelded) {
  // Corners that a file wrote apart, as along texture seams or in a bag of triangles, count as one.
  const TriangleMesh skin = snapped(unwelded, 1e-5 * bounds(unwelded.vertices).size().norm());
  const spatial::SurfaceQuery occluder(lidded(skin));
  const std::array<Vec3, ray_count> directions = hemisphere();
  const Bounds box = bounds(skin.vertices);
  const double lift = 1e-5 * box.size().norm();
  std::vector<bool> outer(skin.triangles.size(), false);
  for (int t = 0; t < skin.triangle_count(); ++t) {
    const Vec3 normal = triangle_normal(skin, t);
    if (normal.squaredNorm() == 0) continue;
    const Vec3 start = position(skin, {t, Vec3::Constant(1.0 / 3)}) + lift * normal;
    const Mat3 turn = frame_about(normal);
    int escaped = 0;
    for (int i = 0; i < ray_count && escaped < rays_needed; ++i) {
      if (escaped + ray_count - i < rays_needed) break;
      if (!occluder.blocked(start, turn * directions[i])) ++escaped;
    }
    outer[t] = escaped >= rays_needed;
  }
  TriangleMesh part;
  part.vertices = skin.vertices;
  std::vector<int> triangle_of;
  for (int t = 0; t < skin.triangle_count(); ++t)
    if (outer[t]) {
      part.triangles.push_back(skin.triangles[t]);
      triangle_of.push_back(t);
    }
  // A surface turned inside out sees nothing but itself: take it whole, the sign test will tell.
  const bool usable = part.triangles.size() >= skin.triangles.size() / 8;
  if (!usable) {
    part.triangles = skin.triangles;
    triangle_of.resize(skin.triangles.size());
    std::iota(triangle_of.begin(), triangle_of.end(), 0);
  }
  Exterior out{spatial::SurfaceQuery(std::move(part)), std::move(triangle_of), {}, {}, border(skin)};
  mark_rims(out.surface.mesh(), out);
  return out;
}

}  // namespace fascia::skull
