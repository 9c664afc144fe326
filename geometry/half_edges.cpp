#include "geometry/half_edges.h"

#include <algorithm>

#include "geometry/connectivity.h"

namespace fascia {

HalfEdges::HalfEdges(const TriangleMesh& mesh) : triangles(mesh.triangles) {
  const Connectivity links = connectivity(mesh);
  twin.assign(3 * triangles.size(), -1);
  leaving.assign(mesh.vertices.size(), -1);
  std::vector<int> corners(mesh.vertices.size(), 0);
  for (int h = 0; h < static_cast<int>(twin.size()); ++h) {
    const int v = from(h), other = links.neighbours[h / 3][h % 3];
    for (int e = 0; other >= 0 && e < 3; ++e)
      if (triangles[other][(e + 1) % 3] == v && triangles[other][e] == to(h)) twin[h] = 3 * other + e;
    if (leaving[v] < 0 || (twin[h] < 0 && twin[leaving[v]] >= 0)) leaving[v] = h;
    ++corners[v];
  }
  fixed.assign(mesh.vertices.size(), 0);
  for (int v = 0; v < static_cast<int>(fixed.size()); ++v)
    fixed[v] = valence(v) != corners[v];
  dead_triangle_.assign(triangles.size(), 0);
  dead_vertex_.assign(fixed.size(), 0);
}

int HalfEdges::valence(int v) const {
  int count = 0;
  around(v, [&](int) { ++count; });
  return count;
}

void HalfEdges::ring(int v, std::vector<int>& out) const {
  out.clear();
  around(v, [&](int h) { out.push_back(to(h)), out.push_back(apex(h)); });
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
}

int HalfEdges::find(int a, int b) const {
  int found = -1;
  around(a, [&](int h) {
    if (to(h) == b) found = h;
  });
  return found;
}

int HalfEdges::find_either(int a, int b) const {
  const int h = find(a, b);
  return h >= 0 ? h : find(b, a);
}

int HalfEdges::before_on_boundary(int v) const {
  int last = -1;
  around(v, [&](int h) { last = h; });
  return last < 0 ? -1 : from(prev(last));
}

bool HalfEdges::may_edit(int h) const {
  if (fixed[from(h)] || fixed[to(h)] || fixed[apex(h)]) return false;
  return twin[h] < 0 || !fixed[apex(twin[h])];
}

void HalfEdges::link(int g, int h) {
  if (g >= 0) twin[g] = h;
  if (h >= 0) twin[h] = g;
}

void HalfEdges::flip(int h) {
  const int g = twin[h], t = 3 * (h / 3), o = 3 * (g / 3);
  const int a = from(h), b = to(h), c = apex(h), d = apex(g);
  const int bc = twin[next(h)], ca = twin[prev(h)], ad = twin[next(g)], db = twin[prev(g)];
  const int from_a = leaving[a], from_b = leaving[b], from_c = leaving[c], from_d = leaving[d];
  const bool a_moves = from_a == h || from_a == next(g), b_moves = from_b == g || from_b == next(h);
  const bool c_moves = from_c == prev(h), d_moves = from_d == prev(g);
  triangles[t / 3] = {a, d, c};
  triangles[o / 3] = {d, b, c};
  link(t, ad), link(t + 2, ca), link(o, db), link(o + 1, bc), link(t + 1, o + 2);
  if (a_moves) leaving[a] = t;
  if (b_moves) leaving[b] = o + 1;
  if (c_moves) leaving[c] = t + 2;
  if (d_moves) leaving[d] = o;
}

int HalfEdges::split(int h) {
  const int g = twin[h], t = 3 * (h / 3), m = static_cast<int>(leaving.size());
  const int a = from(h), b = to(h), c = apex(h);
  leaving.push_back(-1);
  fixed.push_back(0);
  dead_vertex_.push_back(0);
  const auto add = [&](const Triangle& triangle) {
    triangles.push_back(triangle);
    twin.resize(twin.size() + 3, -1);
    dead_triangle_.push_back(0);
    return 3 * (static_cast<int>(triangles.size()) - 1);
  };
  const int bc = twin[next(h)], ca = twin[prev(h)];
  const bool b_moves = leaving[b] == next(h), c_moves = leaving[c] == prev(h), a_here = leaving[a] == h;
  const int n = add({m, b, c});
  triangles[t / 3] = {a, m, c};
  twin[t] = -1, twin[n] = -1;
  link(n + 1, bc), link(t + 2, ca), link(t + 1, n + 2);
  if (a_here) leaving[a] = t;
  if (b_moves) leaving[b] = n + 1;
  if (c_moves) leaving[c] = t + 2;
  leaving[m] = n;
  if (g < 0) return m;

  const int o = 3 * (g / 3), d = apex(g), ad = twin[next(g)], db = twin[prev(g)];
  const bool a_far = leaving[a] == next(g), b_far = leaving[b] == g, d_moves = leaving[d] == prev(g);
  const int k = add({m, a, d});
  triangles[o / 3] = {b, m, d};
  link(k + 1, ad), link(o + 2, db), link(o + 1, k + 2), link(t, k), link(n, o);
  if (a_far) leaving[a] = k + 1;
  if (b_far) leaving[b] = o;
  if (d_moves) leaving[d] = o + 2;
  return m;
}

void HalfEdges::collapse(int h, int kept) {
  const int g = twin[h], b = kept, a = from(h) == kept ? to(h) : from(h);
  // What will leave b.
  std::vector<int> fan;
  for (int v : {a, b})
    around(v, [&](int k) { fan.push_back(k); });
  const auto drop = [&](int k) {  // the triangle of k, whose other two sides become one
    const int c = apex(k), inner = twin[next(k)], outer = twin[prev(k)];
    dead_triangle_[k / 3] = 1;
    if (leaving[c] == prev(k)) leaving[c] = inner;
    link(inner, outer);
  };
  drop(h);
  if (g >= 0) drop(g);
  for (int k : fan)
    if (!dead_triangle_[k / 3] && triangles[k / 3][k % 3] == a) triangles[k / 3][k % 3] = b;
  leaving[a] = -1;
  leaving[b] = -1;
  for (int k : fan)
    if (!dead_triangle_[k / 3] && (leaving[b] < 0 || (twin[k] < 0 && twin[leaving[b]] >= 0))) leaving[b] = k;
  dead_vertex_[a] = 1;
}

std::vector<int> HalfEdges::compact() {
  std::vector<int> stay, live, vertex(leaving.size(), -1), triangle(triangles.size(), -1);
  for (int v = 0; v < static_cast<int>(leaving.size()); ++v) {
    if (dead_vertex_[v]) continue;
    vertex[v] = static_cast<int>(stay.size());
    stay.push_back(v);
  }
  for (int t = 0; t < static_cast<int>(triangles.size()); ++t) {
    if (dead_triangle_[t]) continue;
    triangle[t] = static_cast<int>(live.size());
    live.push_back(t);
  }
  const auto moved = [&](int h) { return h < 0 ? -1 : 3 * triangle[h / 3] + h % 3; };
  for (size_t to = 0; to < live.size(); ++to)
    for (size_t e = 0; e < 3; ++e) {
      const int t = live[to];
      triangles[to][e] = vertex[triangles[t][e]];
      twin[3 * to + e] = moved(twin[3 * static_cast<size_t>(t) + e]);
    }
  triangles.resize(live.size());
  twin.resize(3 * live.size());
  keep_only(stay, leaving);
  keep_only(stay, fixed);
  for (int& h : leaving)
    h = moved(h);
  dead_vertex_.assign(stay.size(), 0);
  dead_triangle_.assign(live.size(), 0);
  return stay;
}

}  // namespace fascia
