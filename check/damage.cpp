#include "check/damage.h"

#include <algorithm>

#include <Eigen/Geometry>

namespace fascia::check {
namespace {

std::vector<Vec3> area_normals(const std::vector<Triangle>& triangles, const std::vector<Vec3>& vertices) {
  std::vector<Vec3> normals;
  normals.reserve(triangles.size());
  for (const Triangle& t : triangles) {
    const Vec3 &a = vertices[static_cast<size_t>(t[0])], &b = vertices[static_cast<size_t>(t[1])],
               &c = vertices[static_cast<size_t>(t[2])];
    normals.push_back((b - a).cross(c - a));
  }
  return normals;
}

/// Cosine between a triangle's normal and the sum of those of its neighbours.
double against_neighbours(const std::vector<Vec3>& normals, const std::array<int, 3>& neighbours, size_t t) {
  Vec3 sum = Vec3::Zero();
  for (const int n : neighbours)
    if (n >= 0) sum += normals[static_cast<size_t>(n)];
  const double length = sum.norm() * normals[t].norm();
  return length > 0.0 ? sum.dot(normals[t]) / length : 1.0;
}

}  // namespace

Damage damage(const Skin& skin, const std::vector<Vec3>& vertices, double least_edge) {
  Damage out;
  const TriangleMesh& rest = skin.rest();
  const std::vector<Vec3> before = area_normals(rest.triangles, rest.vertices),
                          now = area_normals(rest.triangles, vertices);
  constexpr double over = -0.2;     // cosine: beyond a sharp fold
  constexpr double unturned = 0.5;  // cosine, to itself at rest: then its neighbours turned, and they count
  for (size_t t = 0; t < rest.triangles.size(); ++t) {
    const auto& neighbours = skin.links().neighbours[t];
    if (before[t].norm() > least_edge * least_edge && against_neighbours(before, neighbours, t) > 0.0 &&
        against_neighbours(now, neighbours, t) < over &&
        before[t].dot(now[t]) < unturned * before[t].norm() * now[t].norm()) {
      ++out.turned;
      out.turned_place = vertices[static_cast<size_t>(rest.triangles[t][0])];
    }
    for (size_t e = 0; e < 3; ++e) {
      if (neighbours[e] > static_cast<int>(t))
        continue;  // an edge of two triangles is counted with the later one
      const auto a = static_cast<size_t>(rest.triangles[t][e]),
                 b = static_cast<size_t>(rest.triangles[t][(e + 1) % 3]);
      const double length = (rest.vertices[a] - rest.vertices[b]).norm();
      if (length < least_edge) continue;
      const double ratio = (vertices[a] - vertices[b]).norm() / length;
      out.stretched += ratio > most_stretch;
      if (ratio <= out.longest) continue;
      out.longest = ratio;
      out.stretched_place = 0.5 * (vertices[a] + vertices[b]);
    }
  }
  return out;
}

}  // namespace fascia::check
