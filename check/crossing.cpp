#include "check/crossing.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

namespace fascia::check {
namespace {

constexpr double clear = 2e-5;  // metres: off a place's own triangles

std::vector<bool> on_border(const TriangleMesh& mesh, const Connectivity& links) {
  std::vector<bool> border(mesh.vertices.size(), false);
  for (size_t t = 0; t < mesh.triangles.size(); ++t)
    for (size_t e = 0; e < 3; ++e)
      if (links.neighbours[t][e] < 0)
        for (const size_t k : {e, (e + 1) % 3})
          border[static_cast<size_t>(mesh.triangles[t][k])] = true;
  return border;
}

/// Whether a place lies on the surface's border, where there is no telling its sides apart.
bool is_border(const TriangleMesh& mesh, const Connectivity& links, const std::vector<bool>& border,
               const SurfacePoint& p) {
  const auto t = static_cast<size_t>(p.triangle);
  for (size_t k = 0; k < 3; ++k) {
    const double weight = p.barycentric[static_cast<int>(k)];
    if (weight > 1.0 - 1e-6) return border[static_cast<size_t>(mesh.triangles[t][k])];
    if (weight < 1e-6 && links.neighbours[t][(k + 1) % 3] < 0) return true;
  }
  return false;
}

}  // namespace

std::vector<double> depths_behind(const std::vector<Vec3>& places, const std::vector<Vec3>& normals,
                                  const TriangleMesh& other, double deepest, const TriangleMesh& around) {
  std::vector<double> depth(places.size(), 0.0);
  if (other.triangles.empty()) return depth;
  const spatial::SurfaceQuery query(other);
  std::optional<spatial::SurfaceQuery> between;
  const Connectivity links = connectivity(other);
  const std::vector<bool> border = on_border(other, links);
  for (size_t i = 0; i < places.size(); ++i) {
    const spatial::ClosestPoint hit = query.closest(places[i], deepest);
    if (!hit.found() || hit.signed_distance >= 0.0 || hit.pseudonormal.dot(normals[i]) > -0.2 ||
        is_border(other, links, border, hit.surface))
      continue;
    if ((places[i] - hit.position).dot(hit.pseudonormal) > -0.8 * hit.distance) continue;
    if (!around.triangles.empty() && hit.distance > 4.0 * clear) {
      if (!between) between.emplace(around);
      if (between->first_hit(places[i], hit.position - places[i], hit.distance - clear, clear)) continue;
    }
    depth[i] = hit.distance;
  }
  return depth;
}

std::vector<double> CrossingPair::depths(const std::vector<Vec3>& skin, std::vector<Vec3>& places) const {
  const TriangleMesh mesh = places_.mesh(skin);
  places = mesh.vertices;
  std::vector<Vec3> normals = vertex_normals(mesh);
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    places.push_back(position(mesh, {static_cast<int>(t), Vec3::Constant(1.0 / 3.0)}));
    normals.push_back(triangle_normal(mesh, static_cast<int>(t)));
  }
  return depths_behind(places, normals, other_.mesh(skin), deepest_, around_.mesh(skin));
}

CrossingPair::CrossingPair(const Skin& skin, Patch places, Patch other, Patch around, double deepest)
    : places_(std::move(places)), other_(std::move(other)), around_(std::move(around)), deepest_(deepest) {
  std::vector<Vec3> where;
  at_rest_ = depths(skin.rest().vertices, where);
}

Depth CrossingPair::find(const std::vector<Vec3>& skin) const {
  Depth worst;
  std::vector<Vec3> places;
  const std::vector<double> now = depths(skin, places);
  for (size_t i = 0; i < now.size(); ++i)
    worst.take({now[i] - at_rest_[i], places[i]});
  return worst;
}

namespace {

/// The skin of one side of an opening, near its edge. At the very corners, where the two sides are one, there
/// is no telling which of them a place is of: they are left out.
Patch side_patch(const Skin& skin, const Seam& seam, uint8_t side, double reach) {
  const std::vector<Vec3>& vertices = skin.rest().vertices;
  std::vector<Vec3> edge;
  std::vector<bool> is_corner;
  constexpr double corner = 0.08;  // of the width
  for (const std::vector<SurfacePoint>* points : {&seam.upper_edge, &seam.lower_edge})
    for (size_t s = 0; s < points->size(); ++s) {
      edge.push_back(position(skin.rest(), (*points)[s]));
      is_corner.push_back(seam.stations[s] < corner || seam.stations[s] > 1.0 - corner);
    }
  std::vector<bool> keep(vertices.size(), false);
  for (size_t v = 0; v < keep.size(); ++v) {
    if (seam.sides[v] != side) continue;
    double least = std::numeric_limits<double>::infinity();
    bool at_corner = false;
    for (size_t k = 0; k < edge.size(); ++k) {
      const double distance = (vertices[v] - edge[k]).norm();
      if (distance >= least) continue;
      least = distance;
      at_corner = is_corner[k];
    }
    keep[v] = least < reach && !at_corner;
  }
  return patch(skin.rest(), keep);
}

void add_sides(const Skin& skin, const Seam& seam, const char* name, double reach, double deepest,
               Crossings& out) {
  if (seam.empty()) return;
  const Patch upper = side_patch(skin, seam, Seam::upper, reach),
              lower = side_patch(skin, seam, Seam::lower, reach);
  std::vector<bool> is_side(seam.sides.size());
  for (size_t v = 0; v < is_side.size(); ++v)
    is_side[v] = seam.sides[v] != Seam::none;
  const Patch around = patch(skin.rest(), is_side);
  Crossings::Kind kind{name, {}};
  kind.pairs.emplace_back(skin, upper, lower, around, deepest);
  kind.pairs.emplace_back(skin, lower, upper, around, deepest);
  out.kinds.push_back(std::move(kind));
}

}  // namespace

Crossings crossings_of(const Skin& skin, const Seam& mouth, const Seam& lids_left, const Seam& lids_right,
                       double size) {
  Crossings out;
  add_sides(skin, mouth, "lips", 0.01 * size, 0.004 * size, out);
  add_sides(skin, lids_left, "lids_left", 0.006 * size, 0.004 * size, out);
  add_sides(skin, lids_right, "lids_right", 0.006 * size, 0.004 * size, out);
  return out;
}

}  // namespace fascia::check
