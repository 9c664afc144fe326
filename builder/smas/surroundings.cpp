#include "builder/smas/surroundings.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace fascia::smas {

namespace {

// A vertex nearer than this part of the edge length to where a new one would go is taken instead.
constexpr double kReuseDistance = 0.7;

double cross2(const Vec2& a, const Vec2& b) {
  return a[0] * b[1] - a[1] * b[0];
}

bool segments_cross(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  const double s = cross2(b - a, c - a), t = cross2(b - a, d - a);
  if ((s > 0.0) == (t > 0.0)) return false;
  const double u = cross2(d - c, a - c), v = cross2(d - c, b - c);
  return (u > 0.0) != (v > 0.0);
}

bool inside(const Vec2& p, const Vec2& a, const Vec2& b, const Vec2& c) {
  const double s = cross2(b - a, p - a), t = cross2(c - b, p - b), u = cross2(a - c, p - c);
  return (s > 0.0 && t > 0.0 && u > 0.0) || (s < 0.0 && t < 0.0 && u < 0.0);
}

}  // namespace

bool Surroundings::on_sheet(int v) const {
  return front_.normals[v].dot(frame_->n) > 0.0 &&
         std::abs((front_.mesh.vertices[v] - frame_->mid).dot(frame_->n)) < 0.75 * radius_;
}

void Surroundings::gather(const EdgeFrame& frame, double radius) {
  for (const Near& known : near_)
    place_[known.vertex] = -1;
  near_.clear();
  place_.resize(front_.mesh.vertices.size(), -1);
  frame_ = &frame;
  radius_ = radius;
  // What the mesh has closed over is fenced in by edges of the front.
  front_.open.near(frame.mid + 0.4 * frame.size * frame.o, 1.5 * radius, &found_);
  for (int v : found_) {
    place_[v] = static_cast<int>(near_.size());
    near_.push_back({v, flat(front_.mesh.vertices[v]), front_.normals[v].dot(frame.n), on_sheet(v)});
  }
}

bool Surroundings::blocked(const Vec3& p) const {
  const Vec3 u = frame_->pb - frame_->pa, v = p - frame_->pa, w = u.cross(v);
  const double area = w.squaredNorm();
  if (!(area > 0.0)) return true;
  const Vec3 centre =
      frame_->pa + (v.squaredNorm() * w.cross(u) + u.squaredNorm() * v.cross(w)) * (0.5 / area);
  const double radius = (centre - frame_->pa).squaredNorm() * (1.0 - 1e-9);
  const double reuse = kReuseDistance * std::min(frame_->size, (p - frame_->mid).norm() * 1.3);
  for (const Near& q : near_) {
    if (q.vertex == frame_->a || q.vertex == frame_->b || q.cosine < kSameSheet) continue;
    const Vec3& at = front_.mesh.vertices[q.vertex];
    if ((at - centre).squaredNorm() < radius || (at - p).squaredNorm() < reuse * reuse) return true;
  }
  return false;
}

const std::vector<int>& Surroundings::partners() {
  ranked_.clear();
  const int previous = front_.edges[front_.edges[frame_->e].prev].from;
  const int following = front_.edges[front_.edges[frame_->e].next].to;
  const auto consider = [&](int q, double cosine, double ahead) {
    if (q == frame_->a || q == frame_->b || cosine < kSameSheet || ahead < 0.02 * frame_->length) return;
    const Vec3 to_a = frame_->pa - front_.mesh.vertices[q], to_b = frame_->pb - front_.mesh.vertices[q];
    const double far_a = to_a.squaredNorm(), far_b = to_b.squaredNorm();
    if (std::max(far_a, far_b) > radius_ * radius_) return;  // longer edges only breed longer ones
    ranked_.emplace_back(to_a.dot(to_b) / std::max(std::sqrt(far_a * far_b), 1e-300), q);
  };
  for (const Near& near : near_)
    consider(near.vertex, near.cosine, near.flat[1]);
  for (int q : {previous, following})
    if (place_[q] < 0) consider(q, front_.normals[q].dot(frame_->n), flat(front_.mesh.vertices[q])[1]);
  std::sort(ranked_.begin(), ranked_.end());
  ranked_.erase(std::unique(ranked_.begin(), ranked_.end()), ranked_.end());
  partners_.clear();
  for (const auto& [cosine, q] : ranked_)
    partners_.push_back(q);
  return partners_;
}

// Whether front edge `edge`, from `start` to `end` in the plane, crosses a new side of triangle (a, b, c).
bool Surroundings::crosses(int edge, const Vec2& start, const Vec2& end, const Vec2& a, const Vec2& b,
                           const Vec2& c, int apex) const {
  const Front::Edge& rival = front_.edges[edge];
  const auto meets = [&](int v) { return v >= 0 && (rival.from == v || rival.to == v); };
  if (meets(apex)) return false;
  return (!meets(frame_->a) && segments_cross(a, c, start, end)) ||
         (!meets(frame_->b) && segments_cross(b, c, start, end));
}

bool Surroundings::fits(const Vec3& point, const Vec3& normal, int apex) const {
  const EdgeFrame& f = *frame_;
  const Front::Edge& edge = front_.edges[f.e];
  const int previous = front_.edges[edge.prev].from, following = front_.edges[edge.next].to;
  const Vec3 facet = (f.pa - f.pb).cross(point - f.pb);
  const double area = facet.norm();
  if (!(area > 1e-3 * f.length * f.length)) return false;
  for (const Vec3& n : {front_.normals[f.a], front_.normals[f.b], normal})
    if (n.dot(facet) < 0.2 * area) return false;
  if (apex != previous && !front_.in_sector(f.e, point)) return false;
  if (apex != following && !front_.in_sector(edge.next, point)) return false;
  if (apex >= 0 && apex != previous && apex != following && front_.sector(apex, f.mid) < 0) return false;

  // Everything near in the plane of the edge. An edge that crosses has an end within an edge length.
  const Vec2 a = flat(f.pa), b = flat(f.pb), c = flat(point);
  const double low = std::min(0.0, c[1]), high = std::max(0.0, c[1]);
  for (const Near& at : near_) {
    if (!at.on_sheet) continue;
    const int v = at.vertex;
    if (v != f.a && v != f.b && v != apex && inside(at.flat, a, b, c)) return false;
    for (int out : front_.outgoing[v]) {
      for (int other : {out, front_.edges[out].prev}) {
        if (other == f.e) continue;
        const int w = other == out ? front_.edges[other].to : front_.edges[other].from;
        const int place = place_[w];
        // Edges whose both ends are near come up as outgoing ones.
        if (place >= 0 && near_[place].on_sheet && other != out) continue;
        if (place >= 0 ? !near_[place].on_sheet : !on_sheet(w)) continue;
        const Vec2 end = place >= 0 ? near_[place].flat : flat(front_.mesh.vertices[w]);
        if (std::max(at.flat[1], end[1]) < low || std::min(at.flat[1], end[1]) > high) continue;
        if (crosses(other, at.flat, end, a, b, c, apex)) return false;
      }
    }
  }
  return true;
}

}  // namespace fascia::smas
