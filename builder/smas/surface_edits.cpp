#include "builder/smas/surface_edits.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "builder/smas/triangle_shape.h"

namespace fascia::smas {

bool SurfaceField::project(Vec3* point, Vec3* normal, double reach) {
  Vec3 p = *point, gradient;
  for (int i = 0; i < 10; ++i) {
    ++evaluations;
    const double f = function(p, &gradient);
    const double slope = gradient.norm();
    if (!std::isfinite(f) || !std::isfinite(slope) || slope <= 0.0) return false;
    gradient /= slope;
    const double distance = f / slope;
    p -= std::clamp(distance, -reach, reach) * gradient;
    // After a step as short as this the next one would be below the tolerance.
    const bool last = distance * distance < tolerance * reach;
    if (!last) continue;
    if ((p - *point).norm() > 2.0 * reach || gradient.dot(*normal) < 0.2) return false;
    *point = p;
    *normal = gradient;
    return true;
  }
  return false;
}

void split_long_edges(SurfaceField* field, SurfaceMesh* mesh) {
  SurfaceMesh& m = *mesh;
  const int count = static_cast<int>(m.twin.size());
  const int triangles = count / 3;
  std::vector<char> used(m.triangles.size(), 0);
  for (int h = 0; h < count; ++h) {
    const int g = m.twin[h];
    if (used[h / 3] || (g >= 0 && (g < h || g / 3 >= triangles || used[g / 3]))) continue;
    if (m.length(h) < 4.0 / 3.0 * m.wanted(h) || !m.may_edit(h)) continue;
    const int a = m.from(h), b = m.to(h);
    Vec3 p = 0.5 * (m.points[a] + m.points[b]), normal = (m.normals[a] + m.normals[b]).normalized();
    if (!field->project(&p, &normal, 0.5 * m.length(h))) continue;
    used[h / 3] = 1;
    if (g >= 0) used[g / 3] = 1;
    m.split(h, p, normal, m.wanted(h));
  }
}

namespace {

struct CollapseCheck {
  std::vector<int> ring_from, ring_to;

  // Whether `from` can be merged into `to`: the mesh stays manifold (link condition), nothing folds or
  // stretches.
  bool operator()(const SurfaceMesh& m, int from, int to) {
    m.ring(from, ring_from), m.ring(to, ring_to);
    int wings = 0, shared = 0;
    for (int w : ring_from)
      shared += std::binary_search(ring_to.begin(), ring_to.end(), w);
    bool sound = true;
    m.around(from, [&](int h) {
      const int u = m.to(h), w = m.apex(h);
      if (u == to || w == to) {
        ++wings;
        return;
      }
      const Vec3 facing = m.normals[to] + m.normals[u] + m.normals[w];
      sound = sound && is_upright(m.points[to], m.points[u], m.points[w], facing) &&
              smallest_angle_cosine(m.points[to], m.points[u], m.points[w]) < std::cos(0.15);
    });
    if (!sound || shared != wings || ring_from.size() < 3 || wings == 0) return false;
    for (int w : ring_from)
      if (w != to && (m.points[w] - m.points[to]).norm() > 0.8 * (m.sizes[w] + m.sizes[to])) return false;
    return true;
  }
};

}  // namespace

bool collapse_short_edges(double feature_turn, SurfaceMesh* mesh) {
  SurfaceMesh& m = *mesh;
  const double feature = std::cos(feature_turn);
  CollapseCheck can_collapse;
  bool any = false;
  // What was merged this time has changed its place in the order of things: it waits for the next.
  std::vector<char> touched(m.points.size(), 0);
  for (int h = 0; h < static_cast<int>(m.twin.size()); ++h) {
    if (m.gone(h)) continue;
    int a = m.from(h), b = m.to(h);
    const double length = m.length(h), wanted = m.wanted(h);
    if (length > 0.95 * wanted || touched[a] || touched[b]) continue;
    const int around_a = m.valence(a), around_b = m.valence(b);
    const bool border_a = m.on_boundary(a), border_b = m.on_boundary(b);
    // A vertex of three or four triangles has poor angles regardless of the lengths.
    const bool poor = (around_a <= 4 && !border_a) || (around_b <= 4 && !border_b);
    if (!poor && length > 2.0 / 3.0 * wanted) continue;
    if (border_a || (!border_b && around_b < around_a)) std::swap(a, b);
    if (m.on_boundary(a) && !(m.twin[h] < 0 && m.on_boundary(b))) continue;
    if (m.normals[a].dot(m.normals[b]) < feature || !m.may_edit(h) || !can_collapse(m, a, b)) continue;
    for (int v : can_collapse.ring_from)
      touched[v] = 1;
    for (int v : can_collapse.ring_to)
      touched[v] = 1;
    m.collapse(h, b);
    any = true;
  }
  if (any) m.compact();
  return any;
}

std::vector<int> collapse_slivers(double least_angle, SurfaceMesh* mesh) {
  SurfaceMesh& m = *mesh;
  const double limit = std::cos(least_angle);
  CollapseCheck can_collapse;
  for (int t = 0; t < static_cast<int>(m.triangles.size()); ++t) {
    const Triangle& c = m.triangles[t];
    if (m.gone(3 * t) || smallest_angle_cosine(m.points[c[0]], m.points[c[1]], m.points[c[2]]) <= limit)
      continue;
    int shortest = 3 * t;
    for (int h = 3 * t + 1; h < 3 * t + 3; ++h)
      if (m.length(h) < m.length(shortest)) shortest = h;
    for (const auto& [a, b] :
         {std::pair(m.from(shortest), m.to(shortest)), std::pair(m.to(shortest), m.from(shortest))}) {
      if (m.on_boundary(a) || !m.may_edit(shortest) || !can_collapse(m, a, b)) continue;
      m.collapse(shortest, b);
      break;
    }
  }
  return m.compact();
}

namespace {

// Flips the edge of `h` when that makes the smallest of the six angles larger.
bool flip_if_better(double feature, int h, SurfaceMesh* mesh) {
  SurfaceMesh& m = *mesh;
  const int g = m.twin[h];
  const int a = m.from(h), b = m.to(h), c = m.apex(h), d = m.apex(g);
  const Vec3 &pa = m.points[a], &pb = m.points[b], &pc = m.points[c], &pd = m.points[d];
  const double before = std::max(smallest_angle_cosine(pa, pb, pc), smallest_angle_cosine(pb, pa, pd));
  if (before < 0.58 || c == d) return false;  // 54 degrees: good enough
  const double after = std::max(smallest_angle_cosine(pa, pd, pc), smallest_angle_cosine(pd, pb, pc));
  if (after > before - 5e-4) return false;
  const Vec3 across = m.normals[c] + m.normals[d];
  if (!is_upright(pa, pd, pc, across + m.normals[a]) || !is_upright(pd, pb, pc, across + m.normals[b]))
    return false;
  if (m.normals[c].dot(m.normals[d]) < feature || !m.may_edit(h) || m.find(c, d) >= 0 || m.find(d, c) >= 0)
    return false;
  m.flip(h);
  return true;
}

}  // namespace

void flip_edges(double feature_turn, SurfaceMesh* mesh) {
  const double feature = std::cos(feature_turn);
  // After the first round only edges of changed triangles can need a flip.
  std::vector<char> changed(mesh->triangles.size(), 1), next;
  bool flipped = true;
  for (int round = 0; flipped && round < 5; ++round) {
    flipped = false;
    next.assign(changed.size(), 0);
    for (int h = 0; h < static_cast<int>(mesh->twin.size()); ++h) {
      const int g = mesh->twin[h];
      if (g < h || !(changed[h / 3] || changed[g / 3] || next[h / 3] || next[g / 3])) continue;
      if (flip_if_better(feature, h, mesh)) flipped = true, next[h / 3] = next[g / 3] = 1;
    }
    changed.swap(next);
  }
}

}  // namespace fascia::smas
