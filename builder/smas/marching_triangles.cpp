#include "builder/smas/marching_triangles.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <string>

#include "builder/smas/front.h"
#include "builder/smas/surface_quality.h"
#include "geometry/connectivity.h"
#include "geometry/error.h"

namespace fascia::smas {

namespace {

// A vertex nearer than this part of the edge length to where a new one would go is taken instead.
constexpr double kReuseDistance = 0.7;
// Sheets whose normals make less than this cosine are not neighbours.
constexpr double kSameSheet = 0.3;

struct SurfaceHit {
  bool found = false;
  Vec3 point, normal;
};

class Marcher {
 public:
  Marcher(const ImplicitFunction& function, const MarchingOptions& options)
      : function_(function),
        options_(options),
        shortest_(options.min_edge_length > 0.0 ? std::min(options.min_edge_length, options.edge_length)
                                                : options.edge_length),
        tolerance_(options.tolerance * options.edge_length),
        front(options.edge_length) {}

  bool start_from(const Vec3& seed);
  void grow();
  void close_gaps();
  long evaluations() const { return evaluations_; }

 private:
  // An edge with the frame in which its triangle is sought: d along it, o to the free side, n up.
  struct Frame {
    int e, a, b;
    Vec3 pa, pb, mid, d, o, n;
    double length, size;
  };

  double evaluate(const Vec3& point, Vec3* gradient) {
    ++evaluations_;
    return function_(point, gradient);
  }
  SurfaceHit descend(const Vec3& from, double reach);
  SurfaceHit spin(const Frame& frame, double radius);
  SurfaceHit reach_out(const Frame& frame, double* size);
  bool frame_of(int e, Frame* frame) const;
  bool fill(int e, double reach);
  bool valid(const Frame& frame, const Vec3& apex_point, const Vec3& apex_normal, int apex, double reach);
  bool blocked(const Frame& frame, const Vec3& p, const std::vector<int>& near) const;
  std::vector<int> by_angle(const Frame& frame, const std::vector<int>& near, double reach, double least_cosine) const;
  bool join(const Frame& frame, const std::vector<int>& candidates, double reach);
  void push_new(size_t first) {
    for (size_t e = first; e < front.edges.size(); ++e) queue_.push_back(static_cast<int>(e));
  }

  const ImplicitFunction& function_;
  const MarchingOptions& options_;
  const double shortest_, tolerance_;
  long evaluations_ = 0;
  std::deque<int> queue_;
  std::vector<int> deferred_;
  std::vector<int> scratch_;

 public:
  Front front;
};

// Newton's x -= f g / |g|^2, with steps of at most `reach`.
SurfaceHit Marcher::descend(const Vec3& from, double reach) {
  SurfaceHit hit;
  Vec3 p = from, gradient;
  for (int i = 0; i < 40; ++i) {
    const double f = evaluate(p, &gradient);
    const double slope = gradient.norm();
    if (!std::isfinite(f) || !std::isfinite(slope) || slope <= 0.0) return hit;
    const double distance = f / slope;
    if (std::abs(distance) <= tolerance_) {
      hit = {true, p, gradient / slope};
      return hit;
    }
    p -= gradient / slope * std::clamp(distance, -reach, reach);
  }
  return hit;
}

bool Marcher::frame_of(int e, Frame* frame) const {
  const Front::Edge& edge = front.edges[e];
  Frame& f = *frame;
  f.e = e, f.a = edge.from, f.b = edge.to;
  f.pa = front.mesh.vertices[f.a], f.pb = front.mesh.vertices[f.b];
  f.mid = 0.5 * (f.pa + f.pb);
  f.d = f.pb - f.pa;
  f.length = f.d.norm();
  if (!(f.length > 0.0)) return false;
  f.d /= f.length;
  f.n = front.normals[f.a] + front.normals[f.b];
  f.n -= f.d * f.d.dot(f.n);
  const double up = f.n.norm();
  if (!(up > 0.0)) return false;
  f.n /= up;
  f.o = f.d.cross(f.n);
  f.size = 0.5 * (front.sizes[f.a] + front.sizes[f.b]);
  return true;
}

// Edge-spinning: the apex moves on a circle of `radius` about the edge's middle until f = 0.
SurfaceHit Marcher::spin(const Frame& frame, double radius) {
  // What the normals known so far say of the curvature across and along the edge.
  const int c = front.edges[frame.e].opposite;
  const double back = std::max((frame.mid - front.mesh.vertices[c]).dot(frame.o), 0.25 * frame.size);
  const double across = -front.normals[c].dot(frame.o) / back;
  const double along = (front.normals[frame.b] - front.normals[frame.a]).dot(frame.d) / frame.length;
  const double rise = (along * frame.length * frame.length / 8.0) - 0.5 * across * radius * radius;
  double angle = std::clamp(std::atan2(rise, radius), -0.9, 0.9);
  const double bend = std::max({std::abs(across), std::abs(along), 0.3 / radius});
  SurfaceHit hit;
  Vec3 gradient;
  for (int i = 0; i < 12; ++i) {
    const Vec3 out = frame.o * std::cos(angle) + frame.n * std::sin(angle);
    const Vec3 turn = frame.n * std::cos(angle) - frame.o * std::sin(angle);
    const Vec3 p = frame.mid + radius * out;
    const double f = evaluate(p, &gradient);
    const double slope = gradient.norm();
    if (!std::isfinite(f) || !std::isfinite(slope) || slope <= 0.0) return hit;
    const double distance = std::abs(f) / slope;
    const double rate = gradient.dot(turn) * radius;
    if (distance <= tolerance_) {
      hit = {true, p, gradient / slope};
      return hit;
    }
    if (!(rate > 0.05 * slope * radius)) return hit;  // the circle runs along or against the sheet
    const double step = -f / rate;
    // So near that Newton's remainder is below the tolerance: step on, and keep the gradient.
    if (radius * radius * step * step * bend < 0.25 * tolerance_) {
      angle += step;
      hit = {true, Vec3(frame.mid + radius * (frame.o * std::cos(angle) + frame.n * std::sin(angle))), gradient / slope};
      return hit;
    }
    angle += std::clamp(step, -0.5, 0.5);
    if (std::abs(angle) > 1.4) return hit;
  }
  return hit;
}

// Finds the apex of the triangle on `frame`, with shorter steps where the normal turns too far.
SurfaceHit Marcher::reach_out(const Frame& frame, double* size) {
  double step = std::clamp(frame.size, shortest_, options_.edge_length);
  SurfaceHit hit;
  for (int attempt = 0; attempt < 6; ++attempt) {
    const double side = std::max(step, 0.55 * frame.length);
    const double radius = std::max(std::sqrt(side * side - 0.25 * frame.length * frame.length), 0.5 * step);
    hit = spin(frame, radius);
    const bool turned = !hit.found || hit.normal.dot(frame.n) < kSameSheet;
    const double turn = turned ? 1.5 : std::acos(std::clamp(hit.normal.dot(frame.n), -1.0, 1.0));
    // Past the shortest edge only as far as it takes to hold on to the sheet.
    const bool fits = !turned && (turn <= 1.3 * options_.max_normal_turn || step <= shortest_ * 1.001);
    if (fits) {
      const double wanted = turn > 1e-9 ? radius * options_.max_normal_turn / turn : options_.edge_length;
      *size = std::clamp(std::min(wanted, 1.3 * frame.size), shortest_, options_.edge_length);
      return hit;
    }
    if (turned && step < 0.2 * shortest_) break;
    step = turned ? 0.5 * step
                  : std::max(shortest_, step * std::clamp(options_.max_normal_turn / turn, 0.4, 0.85));
  }
  hit.found = false;
  return hit;
}

// Whether a vertex lies in the circumsphere of the triangle to `p`, or so near to `p` that it should be used.
bool Marcher::blocked(const Frame& frame, const Vec3& p, const std::vector<int>& near) const {
  const Vec3 u = frame.pb - frame.pa, v = p - frame.pa, w = u.cross(v);
  const double area = w.squaredNorm();
  if (!(area > 0.0)) return true;
  const Vec3 centre =
      frame.pa + (v.squaredNorm() * w.cross(u) + u.squaredNorm() * v.cross(w)) * (0.5 / area);
  const double radius = (centre - frame.pa).squaredNorm() * (1.0 - 1e-9);
  const double reuse = kReuseDistance * std::min(frame.size, (p - frame.mid).norm() * 1.3);
  for (int q : near) {
    if (q == frame.a || q == frame.b || front.normals[q].dot(frame.n) < kSameSheet) continue;
    const Vec3& at = front.mesh.vertices[q];
    if ((at - centre).squaredNorm() < radius || (at - p).squaredNorm() < reuse * reuse) return true;
  }
  return false;
}

// Front vertices on the free side, the one that a Delaunay triangulation would take (widest angle) first.
std::vector<int> Marcher::by_angle(const Frame& frame, const std::vector<int>& near, double reach,
                                   double least_cosine) const {
  std::vector<std::pair<double, int>> ranked;
  const int previous = front.edges[front.edges[frame.e].prev].from;
  const int following = front.edges[front.edges[frame.e].next].to;
  const auto consider = [&](int q) {
    if (q == frame.a || q == frame.b || !front.on_front(q)) return;
    if (front.normals[q].dot(frame.n) < least_cosine) return;
    const Vec3 from_mid = front.mesh.vertices[q] - frame.mid;
    if (from_mid.dot(frame.o) < 0.02 * frame.length) return;
    const Vec3 to_a = frame.pa - front.mesh.vertices[q], to_b = frame.pb - front.mesh.vertices[q];
    if (std::max(to_a.squaredNorm(), to_b.squaredNorm()) > reach * reach) return;  // longer edges only breed longer ones
    ranked.emplace_back(to_a.dot(to_b) / std::max(to_a.norm() * to_b.norm(), 1e-300), q);
  };
  for (int q : near)
    if (q != previous && q != following) consider(q);
  consider(previous);
  if (following != previous) consider(following);
  std::sort(ranked.begin(), ranked.end());
  std::vector<int> order;
  for (const auto& [cosine, q] : ranked) order.push_back(q);
  return order;
}

double cross2(const Vec2& a, const Vec2& b) { return a[0] * b[1] - a[1] * b[0]; }

bool segments_cross(const Vec2& a, const Vec2& b, const Vec2& c, const Vec2& d) {
  const double s = cross2(b - a, c - a), t = cross2(b - a, d - a);
  const double u = cross2(d - c, a - c), v = cross2(d - c, b - c);
  return ((s > 0.0) != (t > 0.0)) && ((u > 0.0) != (v > 0.0));
}

bool inside(const Vec2& p, const Vec2& a, const Vec2& b, const Vec2& c) {
  const double s = cross2(b - a, p - a), t = cross2(c - b, p - b), u = cross2(a - c, p - c);
  return (s > 0.0 && t > 0.0 && u > 0.0) || (s < 0.0 && t < 0.0 && u < 0.0);
}

// Whether the triangle to the apex (`apex` is -1 when it is new) overlaps nothing that is there.
bool Marcher::valid(const Frame& frame, const Vec3& point, const Vec3& normal, int apex, double reach) {
  const Front::Edge& edge = front.edges[frame.e];
  const int previous = front.edges[edge.prev].from, following = front.edges[edge.next].to;
  const Vec3 facet = (frame.pa - frame.pb).cross(point - frame.pb);
  const double area = facet.norm();
  if (!(area > 1e-3 * frame.length * frame.length)) return false;
  for (const Vec3& n : {front.normals[frame.a], front.normals[frame.b], normal})
    if (n.dot(facet) < 0.2 * area) return false;
  if (apex != previous && !front.in_sector(frame.e, point)) return false;
  if (apex != following && !front.in_sector(edge.next, point)) return false;
  if (apex >= 0 && apex != previous && apex != following && front.sector(apex, frame.mid) < 0) return false;

  // Everything near in the plane of the edge. An edge that crosses has an end within an edge length.
  const auto flat = [&](const Vec3& p) { return Vec2((p - frame.mid).dot(frame.d), (p - frame.mid).dot(frame.o)); };
  const Vec2 a = flat(frame.pa), b = flat(frame.pb), c = flat(point);
  const Vec3 centre = (frame.pa + frame.pb + point) / 3.0;
  front.grid.near(centre, reach, &scratch_);
  const auto on_sheet = [&](int v) {
    return front.normals[v].dot(frame.n) > 0.0 &&
           std::abs((front.mesh.vertices[v] - frame.mid).dot(frame.n)) < 0.5 * reach;
  };
  for (int v : scratch_) {
    if (!front.on_front(v) || !on_sheet(v)) continue;
    const Vec2 at = flat(front.mesh.vertices[v]);
    if (v != frame.a && v != frame.b && v != apex && inside(at, a, b, c)) return false;
    for (int out : front.outgoing[v]) {
      for (int other : {out, front.edges[out].prev}) {
        const Front::Edge& rival = front.edges[other];
        const int w = rival.from == v ? rival.to : rival.from;
        if (other == frame.e || !on_sheet(w)) continue;
        const Vec2 end = flat(front.mesh.vertices[w]);
        const bool at_a = v == frame.a || w == frame.a, at_b = v == frame.b || w == frame.b;
        const bool at_apex = apex >= 0 && (v == apex || w == apex);
        if (!at_a && !at_apex && segments_cross(a, c, at, end)) return false;
        if (!at_b && !at_apex && segments_cross(b, c, at, end)) return false;
      }
    }
  }
  return true;
}

bool Marcher::join(const Frame& frame, const std::vector<int>& candidates, double reach) {
  for (int q : candidates) {
    if (!valid(frame, front.mesh.vertices[q], front.normals[q], q, reach)) continue;
    if (front.connect(frame.e, q)) return true;
  }
  return false;
}

// Puts a triangle on front edge `e`, if one fits; looks for partners `reach` edge lengths around.
bool Marcher::fill(int e, double reach) {
  Frame frame;
  if (!frame_of(e, &frame)) return false;
  const double radius = reach * frame.size;
  std::vector<int> near;
  front.grid.near(frame.mid + 0.6 * frame.size * frame.o, radius, &near);
  const std::vector<int> partners = by_angle(frame, near, radius, kSameSheet);

  // A neighbour along the loop that closes a corner needs no new point at all.
  double size = 0.0;
  const SurfaceHit hit = reach_out(frame, &size);
  const bool allowed = hit.found && (!options_.domain || options_.domain(hit.point));
  if (allowed && !blocked(frame, hit.point, near) && valid(frame, hit.point, hit.normal, -1, 1.5 * radius)) {
    const int p = front.add_vertex(hit.point, hit.normal, size);
    if (front.connect(e, p)) return true;
  }
  std::vector<int> chosen;
  for (int q : partners) {
    const Vec3 to_a = frame.pa - front.mesh.vertices[q], to_b = frame.pb - front.mesh.vertices[q];
    const double cosine = to_a.dot(to_b) / (to_a.norm() * to_b.norm());
    // Outside the domain nothing must be filled: take only well-shaped triangles there.
    const bool shapely = cosine < 0.87 && std::max(to_a.norm(), to_b.norm()) < 1.6 * frame.size;
    if (allowed || !hit.found || shapely) chosen.push_back(q);
  }
  return join(frame, chosen, 1.5 * radius);
}

bool Marcher::start_from(const Vec3& seed) {
  const double length = options_.edge_length;
  const SurfaceHit first = descend(seed, 2.0 * length);
  if (!first.found || (options_.domain && !options_.domain(first.point))) return false;
  std::vector<int> near;
  front.grid.near(first.point, 0.85 * length, &near);
  for (int q : near)
    if (front.normals[q].dot(first.normal) > 0.0) return true;  // meshed already

  for (double step = length; step > 0.05 * shortest_; step *= 0.6) {
    const Vec3 along = first.normal.unitOrthogonal();
    const SurfaceHit second = descend(first.point + step * along, step);
    const SurfaceHit third =
        descend(first.point + step * (0.5 * along + 0.866 * first.normal.cross(along)), step);
    if (!second.found || !third.found) continue;
    const Vec3 facet = (second.point - first.point).cross(third.point - first.point);
    const double turn = std::min(second.normal.dot(first.normal), third.normal.dot(first.normal));
    const bool flat = step > 1.01 * shortest_ ? turn > std::cos(options_.max_normal_turn) : turn > 0.5;
    if (!flat || facet.dot(first.normal) < 0.3 * step * step) continue;
    if (options_.domain && !(options_.domain(second.point) && options_.domain(third.point))) continue;
    const double size = std::clamp(step, shortest_, length);
    const int a = front.add_vertex(first.point, first.normal, size);
    const int b = front.add_vertex(second.point, second.normal, size);
    const int c = front.add_vertex(third.point, third.normal, size);
    const int e = front.add_first_triangle(a, b, c);
    push_new(e);
    return true;
  }
  return false;
}

void Marcher::grow() {
  // Edges that nothing fits wait until their neighbours have moved, and then look further afield.
  for (double reach : {1.6, 1.6, 2.4, 3.5}) {
    bool progress = true;
    for (int round = 0; progress && round < 8; ++round) {
      progress = false;
      queue_.insert(queue_.end(), deferred_.begin(), deferred_.end());
      deferred_.clear();
      while (!queue_.empty()) {
        const int e = queue_.front();
        queue_.pop_front();
        if (!front.edges[e].alive) continue;
        const size_t first = front.edges.size();
        if (fill(e, reach)) {
          push_new(first);
          progress = true;
        } else {
          deferred_.push_back(e);
        }
        if (front.mesh.vertex_count() > options_.max_vertices)
          throw Error("marching triangles: the surface takes more than " + std::to_string(options_.max_vertices) +
                      " vertices; limit its domain or take a larger edge length");
      }
    }
  }
}

// What is still open inside the domain are slits between fronts: cut their loops ear by ear, widest angle last.
void Marcher::close_gaps() {
  std::sort(deferred_.begin(), deferred_.end());
  for (size_t i = 0; i < deferred_.size(); ++i) {
    if (!front.edges[deferred_[i]].alive) continue;
    std::vector<int> loop;
    bool open = true;
    for (int e = deferred_[i]; loop.empty() || e != deferred_[i]; e = front.edges[e].next) {
      loop.push_back(e);
      if (loop.size() > 24) break;
    }
    if (loop.size() > 24) continue;
    // A loop about the end of the domain is meant to stay.
    for (int e : loop) {
      Frame frame;
      if (!options_.domain || !frame_of(e, &frame)) continue;
      if (!options_.domain(frame.mid + 0.7 * frame.size * frame.o)) open = false;
    }
    if (!open) continue;
    int at = loop.front();
    for (size_t left = loop.size(); left >= 3; --left) {
      int best = -1;
      double best_score = -2.0;
      int e = at;
      for (size_t k = 0; k < left; ++k, e = front.edges[e].next) {
        const Vec3& a = front.mesh.vertices[front.edges[e].from];
        const Vec3& b = front.mesh.vertices[front.edges[e].to];
        const Vec3& c = front.mesh.vertices[front.edges[front.edges[e].next].to];
        const Vec3 facet = (a - b).cross(c - b);
        const double cosine = (a - b).normalized().dot((c - b).normalized());
        const double upright = facet.dot(front.normals[front.edges[e].to]) > 0.0 ? 1.0 : 0.0;
        const double score = cosine + 2.0 * upright;
        if (score > best_score) best_score = score, best = e;
      }
      const size_t first = front.edges.size();
      if (!front.connect(best, front.edges[front.edges[best].next].to)) break;
      at = static_cast<int>(first);
      if (front.edges.size() == first) break;
    }
  }
}

void check(const MarchingOptions& options) {
  if (!(options.edge_length > 0.0) || !std::isfinite(options.edge_length))
    throw Error("marching triangles: edge_length must be a positive length");
  if (!(options.min_edge_length >= 0.0) || !(options.max_normal_turn > 0.01) || !(options.tolerance > 0.0))
    throw Error("marching triangles: min_edge_length, max_normal_turn or tolerance is out of range");
  if (options.seeds.empty())
    throw Error("marching triangles: no seeds; give at least one point near each part of the surface");
}

}  // namespace

MarchingResult marching_triangles(const ImplicitFunction& function, const MarchingOptions& options) {
  check(options);
  Marcher marcher(function, options);
  bool started = false;
  for (const Vec3& seed : options.seeds)
    if (seed.allFinite() && marcher.start_from(seed)) {
      started = true;
      marcher.grow();
      marcher.close_gaps();
    }
  if (!started)
    throw Error("marching triangles: none of the " + std::to_string(options.seeds.size()) +
                " seeds reaches the surface within its domain");
  MarchingResult result;
  result.mesh = std::move(marcher.front.mesh);
  result.normals = std::move(marcher.front.normals);
  result.sizes = std::move(marcher.front.sizes);
  result.evaluations = marcher.evaluations();
  if (options.improve) {
    QualityOptions quality;
    quality.tolerance = options.tolerance * options.edge_length;
    result.evaluations += improve_triangles(function, quality, &result.mesh, &result.normals, &result.sizes);
  }
  components(result.mesh, &result.parts);
  const Connectivity links = connectivity(result.mesh);
  for (const auto& neighbours : links.neighbours)
    for (int neighbour : neighbours) result.boundary_edges += neighbour < 0;
  return result;
}

std::vector<Vec3> grid_seeds(const ImplicitFunction& function, const Bounds& box, double spacing) {
  if (!(spacing > 0.0)) throw Error("marching triangles: the spacing of seeds must be positive");
  const Vec3 size = box.size();
  if (!(size.minCoeff() >= 0.0) || !size.allFinite()) throw Error("marching triangles: the box of the seeds is empty");
  std::array<int, 3> count;
  for (int k = 0; k < 3; ++k) count[k] = static_cast<int>(std::floor(size[k] / spacing)) + 2;
  if (static_cast<double>(count[0]) * count[1] * count[2] > 5e7)
    throw Error("marching triangles: too many seeds; take a larger spacing");
  const auto index = [&](int x, int y, int z) { return (static_cast<size_t>(z) * count[1] + y) * count[0] + x; };
  const auto point = [&](int x, int y, int z) { return Vec3(box.lower + spacing * Vec3(x, y, z)); };
  std::vector<double> values(static_cast<size_t>(count[0]) * count[1] * count[2]);
  for (int z = 0; z < count[2]; ++z)
    for (int y = 0; y < count[1]; ++y)
      for (int x = 0; x < count[0]; ++x) values[index(x, y, z)] = function(point(x, y, z), nullptr);
  std::vector<Vec3> seeds;
  for (int z = 0; z < count[2]; ++z)
    for (int y = 0; y < count[1]; ++y)
      for (int x = 0; x < count[0]; ++x)
        for (int k = 0; k < 3; ++k) {
          const std::array<int, 3> to = {x + (k == 0), y + (k == 1), z + (k == 2)};
          if (to[k] >= count[k]) continue;
          const double from = values[index(x, y, z)], there = values[index(to[0], to[1], to[2])];
          if ((from <= 0.0) == (there <= 0.0) || !std::isfinite(from) || !std::isfinite(there)) continue;
          const double part = from / (from - there);
          seeds.push_back(point(x, y, z) + part * (point(to[0], to[1], to[2]) - point(x, y, z)));
        }
  return seeds;
}

}  // namespace fascia::smas
