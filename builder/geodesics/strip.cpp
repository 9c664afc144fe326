#include "builder/geodesics/strip.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <functional>

namespace fascia::geodesics {

namespace {

// The zigzag along edges is longer than the path it stands for: an estimate longer by as much searches
// less and finds the same strips.
constexpr double kZigzag = 1.3;

// A cut longer than this many times the distance has gone around something; a search finds better.
constexpr double kLongestCut = 3.0;

void next_epoch(const Surface& surface, Workspace& workspace) {
  const size_t triangles = surface.mesh.triangles.size();
  const bool fits = workspace.triangle_stamp.size() == triangles &&
                    workspace.vertex_stamp.size() == surface.mesh.vertices.size();
  if (!fits || ++workspace.epoch == 0) {
    workspace.triangle_stamp.assign(triangles, 0);
    const size_t vertices = surface.mesh.vertices.size();
    workspace.vertex_stamp.assign(vertices, 0);
    workspace.vertex_done.assign(vertices, 0);
    workspace.vertex_cost.resize(vertices);
    workspace.vertex_parent.resize(vertices);
    workspace.vertex_entry.resize(vertices);
    workspace.epoch = 1;
  }
}

/// Rates of change of the three barycentric weights when moving along `direction`.
Vec3 barycentric_rates(const TriangleMesh& mesh, int triangle, const Vec3& direction) {
  const Triangle& corners = mesh.triangles[triangle];
  const Vec3 u = mesh.vertices[corners[1]] - mesh.vertices[corners[0]];
  const Vec3 v = mesh.vertices[corners[2]] - mesh.vertices[corners[0]];
  const double uu = u.dot(u), uv = u.dot(v), vv = v.dot(v), du = direction.dot(u), dv = direction.dot(v);
  const double determinant = uu * vv - uv * uv;
  if (!(determinant > 1e-14 * uu * vv)) return Vec3::Zero();
  const double b = (vv * du - uv * dv) / determinant, c = (uu * dv - uv * du) / determinant;
  return Vec3(-b - c, b, c);
}

struct Exit {
  int half_edge = -1;
  SurfacePoint point;
};

/// Where the ray from `at` along `rates` leaves its triangle, not through half-edge `entered`.
Exit leave_triangle(const SurfacePoint& at, const Vec3& rates, int entered) {
  Exit exit;
  double best = 1e300;
  for (int corner = 0; corner < 3; ++corner) {
    const int half_edge = 3 * at.triangle + (corner + 1) % 3;  // opposite to the corner
    if (half_edge == entered || !(rates[corner] < 0.0)) continue;
    const double step = at.barycentric[corner] / -rates[corner];
    if (step < best) {
      best = step;
      exit.half_edge = half_edge;
    }
  }
  if (exit.half_edge < 0) return exit;
  exit.point = at;
  exit.point.barycentric = (at.barycentric + best * rates).cwiseMax(0.0);
  exit.point.barycentric[(exit.half_edge + 2) % 3] = 0.0;
  const double sum = exit.point.barycentric.sum();
  if (sum > 0.0) exit.point.barycentric /= sum;
  return exit;
}

/// At a ridge or a valley the projected direction points back on both sides: slide along the edge to
/// the end that is nearer in direction, and on around that vertex.
Exit slide_along(const Surface& surface, int entered, const Vec3& direction) {
  const Vec3 edge =
      surface.mesh.vertices[surface.target(entered)] - surface.mesh.vertices[surface.origin(entered)];
  Exit exit;
  const bool forward = direction.dot(edge) > 0.0;
  exit.half_edge = forward ? Surface::next(entered) : Surface::previous(entered);
  exit.point = point_on_edge(exit.half_edge, forward ? 0.0 : 1.0);
  return exit;
}

}  // namespace

void push_crossing(const Surface& surface, std::vector<int>& strip, int half_edge) {
  if (!strip.empty() && surface.twin[strip.back()] == half_edge)
    strip.pop_back();
  else
    strip.push_back(half_edge);
}

void turn_strip(const Surface& surface, std::vector<int>& strip) {
  std::reverse(strip.begin(), strip.end());
  for (int& h : strip)
    h = surface.twin[h];
}

bool trace_strip(const Surface& surface, const SurfacePoint& from, const SurfacePoint& to,
                 Workspace& workspace) {
  next_epoch(surface, workspace);
  workspace.strip.clear();
  const Vec3 goal = position(surface.mesh, to);
  SurfacePoint at = from;
  int entered = -1;
  while (at.triangle != to.triangle) {
    if (workspace.triangle_stamp[at.triangle] == workspace.epoch) return false;
    workspace.triangle_stamp[at.triangle] = workspace.epoch;
    const Vec3 direction = goal - position(surface.mesh, at);
    Exit exit = leave_triangle(at, barycentric_rates(surface.mesh, at.triangle, direction), entered);
    if (exit.half_edge < 0 && entered >= 0) exit = slide_along(surface, entered, direction);
    // At a rim of the surface: along the rim, towards the goal.
    if (exit.half_edge >= 0 && surface.twin[exit.half_edge] < 0)
      exit = slide_along(surface, exit.half_edge, direction);
    if (exit.half_edge < 0 || surface.twin[exit.half_edge] < 0) return false;
    workspace.strip.push_back(exit.half_edge);
    at = across(surface, exit.half_edge, exit.point);
    entered = surface.twin[exit.half_edge];
  }
  return true;
}

bool cut_strip(const Surface& surface, const SurfacePoint& from, const SurfacePoint& to,
               Workspace& workspace) {
  workspace.strip.clear();
  const Vec3 start = position(surface.mesh, from), goal = position(surface.mesh, to);
  const Vec3 normal =
      (goal - start)
          .cross(triangle_normal(surface.mesh, from.triangle) + triangle_normal(surface.mesh, to.triangle));
  if (!(normal.squaredNorm() > 0.0)) return false;
  const auto above = [&](int vertex) { return normal.dot(surface.mesh.vertices[vertex] - start) >= 0.0; };
  // With the goal ahead and the surface's normal up, what lies above the plane is on the right.
  int leaving = -1;
  for (int e = 0; e < 3; ++e) {
    const int h = 3 * from.triangle + e;
    if (above(surface.origin(h)) && !above(surface.target(h))) leaving = h;
  }
  double left = kLongestCut * (goal - start).norm();
  Vec3 last = start;
  for (size_t guard = 0; leaving >= 0 && surface.twin[leaving] >= 0 && guard < surface.mesh.triangles.size();
       ++guard) {
    workspace.strip.push_back(leaving);
    const Vec3 here = 0.5 * (surface.mesh.vertices[surface.origin(leaving)] +
                             surface.mesh.vertices[surface.target(leaving)]);
    left -= (here - last).norm();
    last = here;
    if (left < 0.0) return false;
    const int entered = surface.twin[leaving];
    if (entered / 3 == to.triangle) return true;
    leaving = above(surface.opposite(entered)) ? Surface::previous(entered) : Surface::next(entered);
  }
  return false;
}

namespace {

/// A* over the vertices: each is reached by a half-edge, around whose target the search goes on.
class VertexSearch {
 public:
  VertexSearch(const Surface& surface, const SurfacePoint& from, const SurfacePoint& to, Workspace& workspace)
      : surface_(surface), to_(to), goal_(position(surface.mesh, to)), space_(workspace) {
    space_.heap.clear();
    const Vec3 start = position(surface.mesh, from);
    for (int e = 0; e < 3; ++e) {
      const int h = 3 * from.triangle + e;
      reach(h, (surface.mesh.vertices[surface.target(h)] - start).norm(), -1);
    }
  }

  /// The last vertex of the way to a corner of the goal's triangle, or -1.
  int run() {
    auto& heap = space_.heap;
    while (!heap.empty()) {
      std::pop_heap(heap.begin(), heap.end(), std::greater<>());
      const auto [estimate, vertex] = heap.back();
      heap.pop_back();
      if (space_.vertex_done[vertex] == space_.epoch) continue;
      space_.vertex_done[vertex] = space_.epoch;
      ++visited;
      for (const int corner : surface_.mesh.triangles[to_.triangle])
        if (corner == vertex) return vertex;
      spread(vertex);
    }
    return -1;
  }

  int visited = 0;

 private:
  void reach(int h, double cost, int parent) {
    const int vertex = surface_.target(h);
    if (space_.vertex_stamp[vertex] == space_.epoch && space_.vertex_cost[vertex] <= cost) return;
    space_.vertex_stamp[vertex] = space_.epoch;
    space_.vertex_cost[vertex] = cost;
    space_.vertex_parent[vertex] = parent;
    space_.vertex_entry[vertex] = h;
    space_.heap.emplace_back(cost + kZigzag * (goal_ - surface_.mesh.vertices[vertex]).norm(), vertex);
    std::push_heap(space_.heap.begin(), space_.heap.end(), std::greater<>());
  }

  /// Relaxes all edges that leave `vertex` in the fan it was reached through.
  void spread(int vertex) {
    const double cost = space_.vertex_cost[vertex];
    const int first = Surface::next(space_.vertex_entry[vertex]);
    int h = first;
    do {
      reach(h, cost + surface_.length[h], vertex);
      const int far = Surface::previous(h);
      h = surface_.twin[far];
      if (h < 0) break;
    } while (h != first);
    if (h == first) return;
    // A rim stopped the turn: its own edge, then the other way around.
    int last = first;
    for (int twin = surface_.twin[last]; twin >= 0; twin = surface_.twin[last]) {
      last = Surface::next(twin);
      reach(last, cost + surface_.length[last], vertex);
    }
    rim(vertex, first, cost);
  }

  /// The rim edge that ends in `vertex`, which no half-edge leaves along.
  void rim(int vertex, int first, double cost) {
    int h = first;
    while (surface_.twin[Surface::previous(h)] >= 0)
      h = surface_.twin[Surface::previous(h)];
    const int incoming = Surface::previous(h);
    const int other = surface_.origin(incoming);
    // `other` is entered by the half-edge before the rim edge, of the same triangle.
    if (space_.vertex_done[other] != space_.epoch)
      reach(Surface::previous(incoming), cost + surface_.length[incoming], vertex);
  }

  const Surface& surface_;
  const SurfacePoint& to_;
  const Vec3 goal_;
  Workspace& space_;
};

/// Half-edge of `triangle` that starts at `vertex`.
int corner_at(const Surface& surface, int triangle, int vertex) {
  for (int e = 0; e < 3; ++e)
    if (surface.mesh.triangles[triangle][e] == vertex) return 3 * triangle + e;
  return -1;
}

/// Turns around `vertex` from `triangle` to the first triangle that `arrived` accepts, on the side with
/// fewer crossings, and appends them to the strip. Returns the triangle reached, or -1.
template <class Arrived>
int turn(const Surface& surface, int vertex, int triangle, const Arrived& arrived, Workspace& workspace) {
  if (arrived(triangle)) return triangle;
  int ahead = corner_at(surface, triangle, vertex), behind = ahead;
  auto &left = workspace.left_turn, &right = workspace.right_turn;
  left.clear();
  right.clear();
  while (ahead >= 0 || behind >= 0) {
    if (ahead >= 0) {
      left.push_back(Surface::previous(ahead));
      ahead = surface.twin[left.back()];
      if (ahead >= 0 && arrived(ahead / 3)) {
        for (const int h : left)
          push_crossing(surface, workspace.strip, h);
        return ahead / 3;
      }
      if (ahead >= 0 && ahead / 3 == triangle) return -1;
    }
    if (behind >= 0) {
      right.push_back(behind);
      const int twin = surface.twin[behind];
      behind = twin >= 0 ? Surface::next(twin) : -1;
      if (behind >= 0 && arrived(behind / 3)) {
        for (const int h : right)
          push_crossing(surface, workspace.strip, h);
        return behind / 3;
      }
    }
  }
  return -1;
}

}  // namespace

int search_strip(const Surface& surface, const SurfacePoint& from, const SurfacePoint& to,
                 Workspace& workspace) {
  next_epoch(surface, workspace);
  workspace.strip.clear();
  if (from.triangle == to.triangle) return 0;
  VertexSearch search(surface, from, to, workspace);
  auto& way = workspace.way;
  way.clear();
  for (int vertex = search.run(); vertex >= 0; vertex = workspace.vertex_parent[vertex])
    way.push_back(vertex);
  std::reverse(way.begin(), way.end());
  int triangle = from.triangle;
  for (size_t i = 0; i < way.size() && triangle >= 0; ++i) {
    const bool last = i + 1 == way.size();
    triangle = turn(
        surface, way[i], triangle,
        [&](int t) { return last ? t == to.triangle : corner_at(surface, t, way[i + 1]) >= 0; }, workspace);
  }
  return search.visited;
}

}  // namespace fascia::geodesics
