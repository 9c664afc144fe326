#include "builder/geodesics/strip.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <functional>

namespace fascia::geodesics {

namespace {

// The zigzag through edge midpoints is longer than the path it stands for: an estimate longer by as
// much searches less and finds the same strips.
constexpr double kZigzag = 1.15;

void next_epoch(const Surface& surface, Workspace& workspace) {
  const size_t triangles = surface.mesh.triangles.size();
  const bool fits = workspace.triangle_stamp.size() == triangles;
  if (!fits || ++workspace.epoch == 0) {
    workspace.triangle_stamp.assign(triangles, 0);
    workspace.edge_stamp.assign(3 * triangles, 0);
    workspace.edge_cost.resize(3 * triangles);
    workspace.edge_parent.resize(3 * triangles);
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
  const Vec3 edge = surface.mesh.vertices[surface.target(entered)] - surface.mesh.vertices[surface.origin(entered)];
  Exit exit;
  const bool forward = direction.dot(edge) > 0.0;
  exit.half_edge = forward ? Surface::next(entered) : Surface::previous(entered);
  exit.point = point_on_edge(exit.half_edge, forward ? 0.0 : 1.0);
  return exit;
}

}  // namespace

bool trace_strip(const Surface& surface, const SurfacePoint& from, const SurfacePoint& to, Workspace& workspace) {
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

int search_strip(const Surface& surface, const SurfacePoint& from, const SurfacePoint& to, Workspace& workspace) {
  next_epoch(surface, workspace);
  workspace.strip.clear();
  if (from.triangle == to.triangle) return 0;
  const Vec3 start = position(surface.mesh, from), goal = position(surface.mesh, to);
  const auto middle = [&](int h) {
    return Vec3(0.5 * (surface.mesh.vertices[surface.origin(h)] + surface.mesh.vertices[surface.target(h)]));
  };
  auto& heap = workspace.heap;
  heap.clear();
  const auto reach = [&](int h, double cost, int parent) {
    if (surface.twin[h] < 0) return;
    if (workspace.edge_stamp[h] == workspace.epoch && workspace.edge_cost[h] <= cost) return;
    workspace.edge_stamp[h] = workspace.epoch;
    workspace.edge_cost[h] = cost;
    workspace.edge_parent[h] = parent;
    heap.emplace_back(cost + kZigzag * (goal - middle(h)).norm(), h);
    std::push_heap(heap.begin(), heap.end(), std::greater<>());
  };
  for (int e = 0; e < 3; ++e) {
    const int h = 3 * from.triangle + e;
    reach(h, (middle(h) - start).norm(), -1);
  }
  int visited = 0;
  while (!heap.empty()) {
    std::pop_heap(heap.begin(), heap.end(), std::greater<>());
    const auto [estimate, h] = heap.back();
    heap.pop_back();
    const Vec3 here = middle(h);
    if (estimate > workspace.edge_cost[h] + kZigzag * (goal - here).norm()) continue;  // superseded
    ++visited;
    const int twin = surface.twin[h];
    if (twin / 3 == to.triangle) {
      for (int back = h; back >= 0; back = workspace.edge_parent[back]) workspace.strip.push_back(back);
      std::reverse(workspace.strip.begin(), workspace.strip.end());
      break;
    }
    for (const int onward : {Surface::next(twin), Surface::previous(twin)})
      reach(onward, workspace.edge_cost[h] + (middle(onward) - here).norm(), h);
  }
  return visited;
}

}  // namespace fascia::geodesics
