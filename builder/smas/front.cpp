#include "builder/smas/front.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace fascia::smas {

namespace {

// Angle from `from` clockwise to `to` about `normal`, in [0, 2 pi).
double clockwise_angle(const Vec3& normal, const Vec3& from, const Vec3& to) {
  const double angle =
      std::atan2(-normal.dot(from.cross(to)), from.dot(to) - normal.dot(from) * normal.dot(to));
  return angle < 0.0 ? angle + 2.0 * M_PI : angle;
}

}  // namespace

int Front::add_vertex(const Vec3& position, const Vec3& normal, double size) {
  mesh.vertices.push_back(position);
  normals.push_back(normal);
  sizes.push_back(size);
  outgoing.emplace_back();
  joined_.emplace_back().reserve(8);
  all.add(position);
  open.add(position);
  return mesh.vertex_count() - 1;
}

int Front::add_first_triangle(int a, int b, int c) {
  mesh.triangles.push_back({a, b, c});
  const int ab = add_edge(a, b, c), bc = add_edge(b, c, a), ca = add_edge(c, a, b);
  link(ab, bc), link(bc, ca), link(ca, ab);
  return ab;
}

int Front::add_edge(int from, int to, int opposite) {
  edges.push_back({from, to, -1, -1, opposite, true});
  const int e = static_cast<int>(edges.size()) - 1;
  outgoing[from].push_back(e);
  joined_[from].push_back(to);
  joined_[to].push_back(from);
  return e;
}

void Front::kill(int e) {
  edges[e].alive = false;
  std::vector<int>& out = outgoing[edges[e].from];
  out.erase(std::find(out.begin(), out.end(), e));
}

bool Front::in_sector(int e, const Vec3& point) const {
  const int v = edges[e].from, before = edges[edges[e].prev].from;
  const Vec3& at = mesh.vertices[v];
  const Vec3 along = mesh.vertices[edges[e].to] - at;
  const double gap = clockwise_angle(normals[v], along, mesh.vertices[before] - at);
  const double angle = clockwise_angle(normals[v], along, point - at);
  return angle > 0.0 && angle < gap;
}

int Front::sector(int vertex, const Vec3& point) const {
  for (int e : outgoing[vertex])
    if (in_sector(e, point)) return e;
  return -1;
}

bool Front::connect(int e, int apex) {
  const int corners[] = {edges[e].from, edges[e].to, apex};
  if (!fill(e, apex)) return false;
  for (int v : corners)
    if (!on_front(v)) open.remove(v);
  return true;
}

bool Front::fill(int e, int apex) {
  const int a = edges[e].from, b = edges[e].to;
  const int prev = edges[e].prev, next = edges[e].next;
  const bool closes_prev = edges[prev].from == apex, closes_next = edges[next].to == apex;
  if (!closes_prev && has_edge(a, apex)) return false;
  if (!closes_next && has_edge(apex, b)) return false;
  if (closes_prev && closes_next) {
    const int before = edges[prev].prev, after = edges[next].next;
    kill(e), kill(prev), kill(next);
    if (before != next) link(before, after);
  } else if (closes_prev) {
    const int before = edges[prev].prev;
    kill(e), kill(prev);
    const int edge = add_edge(apex, b, a);
    link(before, edge), link(edge, next);
  } else if (closes_next) {
    const int after = edges[next].next;
    kill(e), kill(next);
    const int edge = add_edge(a, apex, b);
    link(prev, edge), link(edge, after);
  } else {
    int leaving = -1, arriving = -1;
    if (on_front(apex)) {
      leaving = sector(apex, 0.5 * (mesh.vertices[a] + mesh.vertices[b]));
      if (leaving < 0) return false;
      arriving = edges[leaving].prev;
    }
    kill(e);
    const int in = add_edge(a, apex, b), out = add_edge(apex, b, a);
    link(prev, in), link(out, next);
    if (leaving < 0) {
      link(in, out);
    } else {
      link(in, leaving), link(arriving, out);
    }
  }
  mesh.triangles.push_back({b, a, apex});
  return true;
}

}  // namespace fascia::smas
