#include "tools/anatomy/head/drape.h"

#include <Eigen/Geometry>
#include <set>

namespace fascia::head_maker {

std::vector<Vec3> half_normals(const HalfHead& head) {
  std::vector<Vec3> normals(head.vertices.size(), Vec3::Zero());
  for (const Quad& q : head.quads) {
    const auto& v = head.vertices;
    const Vec3 n = (v[q[2]] - v[q[0]]).cross(v[q[3]] - v[q[1]]);
    for (int i : q)
      normals[i] += n;
  }
  for (std::size_t i = 0; i < normals.size(); ++i) {
    if (head.midline[i]) normals[i].x() = 0.0;
    if (normals[i].norm() > 0.0) normals[i].normalize();
  }
  return normals;
}

namespace {

/// The plane the neck ends in: lower in front than behind.
double neck_end_height(double z) {
  return -109.0 - 0.20 * z;
}

std::vector<std::set<int>> neighbours_of(const HalfHead& head) {
  std::vector<std::set<int>> out(head.vertices.size());
  for (const Quad& q : head.quads)
    for (int k = 0; k < 4; ++k) {
      out[q[k]].insert(q[(k + 1) % 4]);
      out[q[(k + 1) % 4]].insert(q[k]);
    }
  return out;
}

}  // namespace

void drape(const SkinSurface& surface, const std::vector<char>& fixed, HalfHead& head,
           const DrapeOptions& options) {
  const auto neighbours = neighbours_of(head);
  std::vector<char> at_neck_end(head.vertices.size(), 0);
  for (int v : head.loops.at("neck_end"))
    at_neck_end[v] = 1;
  const auto settle = [&](int v, const Vec3& point, const Vec3& normal) {
    Vec3 p = point;
    for (int round = 0; round < (at_neck_end[v] ? 3 : 1); ++round) {
      p = surface.project(p, normal);
      if (head.midline[v]) p.x() = 0.0;
      if (at_neck_end[v]) p.y() = neck_end_height(p.z());
    }
    return p;
  };
  std::vector<Vec3> normals = half_normals(head);
  for (std::size_t v = 0; v < head.vertices.size(); ++v)
    if (fixed[v] != 2) head.vertices[v] = settle(static_cast<int>(v), head.vertices[v], normals[v]);
  const std::vector<Vec3> home = head.vertices;
  // Springs weaker the longer they were, so that rows keep their spacing.
  const auto stiffness = [&](int a, int b) { return 1.0 / std::max((home[a] - home[b]).norm(), 0.5); };
  for (int iteration = 0; iteration < options.iterations; ++iteration) {
    normals = half_normals(head);
    const std::vector<Vec3> old = head.vertices;
    for (std::size_t v = 0; v < old.size(); ++v) {
      if (fixed[v] == 2) continue;
      Vec3 mean = Vec3::Zero();
      double weight = 0.0;
      for (int n : neighbours[v]) {
        // A neighbour off the midline has its mirror image on the other side.
        const double w =
            stiffness(static_cast<int>(v), n) * (head.midline[v] && !head.midline[n] ? 2.0 : 1.0);
        if (at_neck_end[v] && !at_neck_end[n]) continue;
        mean += w * old[n];
        weight += w;
      }
      Vec3 move = options.step * (mean / weight - old[v]);
      move -= normals[v] * normals[v].dot(move);
      Vec3 p = old[v] + move;
      if (fixed[v] == 1) p += options.anchor * (home[v] - p);
      if (head.midline[v]) p.x() = 0.0;
      head.vertices[v] = settle(static_cast<int>(v), p, normals[v]);
    }
  }
}

}  // namespace fascia::head_maker
