#include "builder/geodesics/path.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "builder/geodesics/cross.h"
#include "builder/geodesics/funnel.h"
#include "builder/geodesics/strip.h"
#include "geometry/error.h"

namespace fascia::geodesics {

namespace {

constexpr double kPi = 3.14159265358979323846;

double angle_between(const Vec2& a, const Vec2& b) {
  return std::atan2(std::abs(cross(a, b)), a.dot(b));
}

/// Corner 0..2 of its triangle that `point` sits on, or -1.
int corner_of(const SurfacePoint& point) {
  for (int i = 0; i < 3; ++i)
    if (point.barycentric[i] == 1.0) return i;
  return -1;
}

/// Drops crossings at the start of the strip that the path need not make because `from` lies on them.
void trim_start(const Surface& surface, std::vector<int>& strip, SurfacePoint& from) {
  size_t drop = 0;
  if (const int corner = corner_of(from); corner >= 0) {
    // From a vertex every triangle around it is open: begin at the last one the strip comes through.
    const int vertex = surface.mesh.triangles[from.triangle][corner];
    for (size_t k = 0; k < strip.size(); ++k)
      if (surface.origin(strip[k]) == vertex || surface.target(strip[k]) == vertex) drop = k + 1;
    if (drop > 0) {
      const int twin = surface.twin[strip[drop - 1]];
      const bool at_origin = surface.origin(twin) == vertex;
      from = point_on_edge(twin, at_origin ? 0.0 : 1.0);
    }
  } else {
    while (drop < strip.size() && from.barycentric[Surface::previous(strip[drop]) % 3] == 0.0) {
      from = across(surface, strip[drop], from);
      ++drop;
    }
  }
  strip.erase(strip.begin(), strip.begin() + static_cast<std::ptrdiff_t>(drop));
}

/// The same at the end of the strip.
void trim_end(const Surface& surface, std::vector<int>& strip, SurfacePoint& to) {
  if (const int corner = corner_of(to); corner >= 0) {
    const int vertex = surface.mesh.triangles[to.triangle][corner];
    for (size_t k = 0; k < strip.size(); ++k)
      if (surface.origin(strip[k]) == vertex || surface.target(strip[k]) == vertex) {
        to = point_on_edge(strip[k], surface.origin(strip[k]) == vertex ? 0.0 : 1.0);
        strip.resize(k);
        return;
      }
  } else {
    while (!strip.empty() && to.barycentric[Surface::previous(surface.twin[strip.back()]) % 3] == 0.0) {
      to = across(surface, surface.twin[strip.back()], to);
      strip.pop_back();
    }
  }
}

/// A vertex on the taut path: the crossings it spans, and the angles on both sides of the path.
struct Bend {
  int first = 0, last = 0;
  double inside = 0.0;   // on the side of the strip
  double outside = 0.0;  // on the other side, infinite at a boundary
};

/// Turns around the vertex of `bend` outside the strip, from the triangle before its first crossing to
/// the one after its last: appends the crossings to `detour` when given, adds up their angles.
/// Returns false when a boundary is in the way.
bool turn_outside(const Surface& surface, const std::vector<int>& strip, const Bend& bend, bool left,
                  std::vector<int>* detour, double& angle) {
  const int goal = surface.twin[strip[bend.last]] / 3;
  int at = strip[bend.first];
  angle = 0.0;
  // The other edge at the vertex: a left vertex is the crossed half-edge's target, turned around
  // counter-clockwise; a right one its origin, turned around clockwise.
  for (size_t guard = 0; guard < surface.twin.size(); ++guard) {
    const int exit = left ? Surface::next(at) : Surface::previous(at);
    angle += left ? surface.angle[exit] : surface.angle[at];
    if (at / 3 == goal && guard > 0) return true;
    if (surface.twin[exit] < 0) return false;
    if (detour) push_crossing(surface, *detour, exit);
    at = surface.twin[exit];
    if (detour && at / 3 == goal) return true;
  }
  return false;
}

/// Angles at inner node `index` of the taut path.
Bend measure_bend(const Surface& surface, const Workspace& workspace, size_t index) {
  const auto& nodes = workspace.nodes;
  const auto& before = nodes[workspace.taut[index - 1]];
  const auto& node = nodes[workspace.taut[index]];
  const auto& after = nodes[workspace.taut[index + 1]];
  Bend bend;
  bend.first = node.first;
  bend.last = std::min(node.last, after.first - 1);
  const auto facing = [&](int k) {
    const auto& other = nodes[node.left ? workspace.right_node[k] : workspace.left_node[k]];
    return Vec2(other.place - node.place);
  };
  const double entry = angle_between(before.place - node.place, facing(bend.first));
  const double exit = angle_between(facing(bend.last), after.place - node.place);
  bend.inside = entry + exit;
  for (int k = bend.first; k < bend.last; ++k) {
    // The triangle between crossings k and k+1 has its corner at the node.
    const int entered = surface.twin[workspace.strip[k]];
    bend.inside += surface.angle[node.left ? entered : Surface::next(entered)];
  }
  const int h = workspace.strip[bend.first], g = surface.twin[workspace.strip[bend.last]];
  const double corner_in = surface.angle[node.left ? Surface::next(h) : h];
  double around = 0.0;
  if (h / 3 == g / 3)
    bend.outside = corner_in - entry - exit;  // the strip goes all the way around the vertex
  else if (turn_outside(surface, workspace.strip, bend, node.left, nullptr, around))
    bend.outside = around - entry - exit;
  else
    bend.outside = std::numeric_limits<double>::infinity();
  return bend;
}

/// Leads the strip around every vertex whose far side is narrower than π. Returns how many.
int reroute(const Surface& surface, const PathOptions& options, Workspace& workspace) {
  workspace.rerouted.clear();
  int count = 0, copied = 0;
  for (size_t i = 1; i + 1 < workspace.taut.size(); ++i) {
    const Bend bend = measure_bend(surface, workspace, i);
    if (!(bend.outside < kPi - options.angle_tolerance)) continue;
    for (; copied < bend.first; ++copied)
      push_crossing(surface, workspace.rerouted, workspace.strip[copied]);
    const int before = workspace.strip[bend.first] / 3, after = surface.twin[workspace.strip[bend.last]] / 3;
    double angle = 0.0;
    if (before != after)
      turn_outside(surface, workspace.strip, bend, workspace.nodes[workspace.taut[i]].left,
                   &workspace.rerouted, angle);
    copied = bend.last + 1;
    ++count;
  }
  if (count == 0) return 0;
  for (; copied < static_cast<int>(workspace.strip.size()); ++copied)
    push_crossing(surface, workspace.rerouted, workspace.strip[copied]);
  std::swap(workspace.strip, workspace.rerouted);
  return count;
}

/// Runs of the taut path between turns of more than the tolerance.
int count_straight_lengths(const Workspace& workspace, double tolerance) {
  int runs = 1;
  for (size_t i = 1; i + 1 < workspace.taut.size(); ++i) {
    const Vec2& a = workspace.nodes[workspace.taut[i - 1]].place;
    const Vec2& b = workspace.nodes[workspace.taut[i]].place;
    const Vec2& c = workspace.nodes[workspace.taut[i + 1]].place;
    if (angle_between(b - a, c - b) > tolerance) ++runs;
  }
  return runs;
}

void append(const Surface& surface, const SurfacePoint& point, int crossing, Workspace& workspace,
            Path& path) {
  workspace.point_crossing.push_back(crossing);
  path.points.push_back(point);
  path.positions.push_back(position(surface.mesh, point));
}

/// Points of the taut path: edge crossings between its nodes, and the vertices it passes.
void emit(const Surface& surface, const SurfacePoint& from, const SurfacePoint& to, Workspace& workspace,
          Path& path) {
  const std::vector<int>& strip = workspace.strip;
  append(surface, from, 0, workspace, path);
  int k = 0;
  for (size_t i = 1; i < workspace.taut.size(); ++i) {
    const auto& a = workspace.nodes[workspace.taut[i - 1]];
    const auto& b = workspace.nodes[workspace.taut[i]];
    const bool last = i + 1 == workspace.taut.size();
    const int stop = last ? static_cast<int>(strip.size()) : b.first;
    for (; k < stop; ++k) {
      const Vec2& right = workspace.nodes[workspace.right_node[k]].place;
      const Vec2& left = workspace.nodes[workspace.left_node[k]].place;
      const Vec2 along = b.place - a.place;
      const double whole = cross(left - right, along);
      const double share = whole != 0.0 ? std::clamp(cross(a.place - right, along) / whole, 0.0, 1.0) : 0.5;
      append(surface, point_on_edge(strip[k], share), k, workspace, path);
    }
    if (last) break;
    append(surface, point_on_edge(strip[b.first], b.left ? 1.0 : 0.0), b.first, workspace, path);
    const auto& after = workspace.nodes[workspace.taut[i + 1]];
    k = std::min(b.last, after.first - 1) + 1;
  }
  append(surface, to, static_cast<int>(workspace.strip.size()), workspace, path);
}

/// Pinned vertices and how unevenly the path divides the angle at those inside the surface.
void measure_pins(const Surface& surface, Workspace& workspace, PathCounters& counters) {
  counters.pinned_vertices = static_cast<int>(workspace.taut.size()) - 2;
  for (size_t i = 1; i + 1 < workspace.taut.size(); ++i) {
    const Bend bend = measure_bend(surface, workspace, i);
    if (std::isfinite(bend.outside))
      counters.unevenness = std::max(counters.unevenness, std::abs(bend.inside - bend.outside) /
                                                              std::max(bend.inside + bend.outside, 1e-12));
  }
}

/// Total order of points, so that a path and its reverse are computed alike.
bool ordered(const SurfacePoint& a, const SurfacePoint& b) {
  if (a.triangle != b.triangle) return a.triangle < b.triangle;
  return std::lexicographical_compare(a.barycentric.data(), a.barycentric.data() + 3, b.barycentric.data(),
                                      b.barycentric.data() + 3);
}

/// Turns a path around, keeping each segment's triangle with the point that ends it.
void reverse_path(const Surface& surface, Path& path) {
  for (size_t i = 0; i + 1 < path.points.size(); ++i) {
    // Segment i → i+1 lies in points[i+1]'s triangle; reversed, it must be named by point i.
    const int triangle = path.points[i + 1].triangle;
    SurfacePoint& point = path.points[i];
    if (point.triangle == triangle) continue;
    Vec3 weights = Vec3::Zero();
    const Triangle &own = surface.mesh.triangles[point.triangle], &other = surface.mesh.triangles[triangle];
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b)
        if (own[a] == other[b]) weights[b] = point.barycentric[a];
    point.triangle = triangle;
    point.barycentric = weights;
  }
  std::reverse(path.points.begin(), path.points.end());
  std::reverse(path.positions.begin(), path.positions.end());
}

}  // namespace

void straighten_strip(const Surface& surface, SurfacePoint from, SurfacePoint to, const PathOptions& options,
                      Workspace& workspace, Path& path) {
  path.points.clear();
  path.positions.clear();
  workspace.point_crossing.clear();
  PathCounters& counters = path.counters;
  counters.converged = false;
  double shortest = std::numeric_limits<double>::infinity();
  int without_gain = 0;
  while (true) {
    trim_start(surface, workspace.strip, from);
    trim_end(surface, workspace.strip, to);
    ++counters.passes;
    if (workspace.strip.empty()) break;
    path.length = pull_taut(surface, from, to, workspace);
    if (counters.passes == 1) counters.first_straight_lengths = count_straight_lengths(workspace, 1e-7);
    // Rerouting always gains, but at angles close to π less than rounding loses.
    without_gain = path.length < shortest * (1.0 - 1e-14) ? 0 : without_gain + 1;
    shortest = std::min(shortest, path.length);
    if (without_gain > 8) {
      counters.converged = true;
      break;
    }
    if (counters.passes >= options.maximum_passes) break;
    const int rerouted = reroute(surface, options, workspace);
    if (rerouted == 0) {
      counters.converged = true;
      break;
    }
    counters.rerouted_vertices += rerouted;
  }
  if (workspace.strip.empty()) {
    counters.converged = true;
    counters.straight_lengths = 1;
    counters.first_straight_lengths = std::max(counters.first_straight_lengths, 1);
    path.length = (position(surface.mesh, to) - position(surface.mesh, from)).norm();
    append(surface, from, 0, workspace, path);
    append(surface, to, static_cast<int>(workspace.strip.size()), workspace, path);
    return;
  }
  counters.straight_lengths = count_straight_lengths(workspace, 1e-7);
  measure_pins(surface, workspace, counters);
  emit(surface, from, to, workspace, path);
}

void connect_into(const Surface& surface, const SurfacePoint& from, const SurfacePoint& to,
                  const PathOptions& options, Workspace& workspace, Path& path) {
  SurfacePoint a = checked(surface, from), b = checked(surface, to);
  if (surface.piece[a.triangle] != surface.piece[b.triangle])
    throw Error("geodesic: triangles " + std::to_string(a.triangle) + " and " + std::to_string(b.triangle) +
                " lie on parts of the surface that no chain of triangles connects; join the parts or choose "
                "ends on one");
  const bool turned = ordered(b, a);
  if (turned) std::swap(a, b);
  path.counters = PathCounters();
  bool traced = !options.search_first && trace_strip(surface, a, b, workspace);
  if (!traced && !options.search_first && trace_strip(surface, b, a, workspace)) {
    traced = true;
    turn_strip(surface, workspace.strip);
  }
  if (!traced && !options.search_first) path.counters.cut = traced = cut_strip(surface, a, b, workspace);
  if (!traced) {
    path.counters.searched = true;
    path.counters.searched_vertices = search_strip(surface, a, b, workspace);
  }
  path.counters.traced_triangles = static_cast<int>(workspace.strip.size()) + 1;
  straighten_strip(surface, a, b, options, workspace, path);
  if (turned) reverse_path(surface, path);
}

Path connect(const Surface& surface, const SurfacePoint& from, const SurfacePoint& to,
             const PathOptions& options, Workspace& workspace) {
  Path path;
  connect_into(surface, from, to, options, workspace, path);
  return path;
}

Path connect(const Surface& surface, const SurfacePoint& from, const SurfacePoint& to,
             const PathOptions& options) {
  Workspace workspace;
  return connect(surface, from, to, options, workspace);
}

SurfacePoint point_along(const Surface& surface, const Path& path, double distance) {
  double left = distance;
  for (size_t i = 0; i + 1 < path.points.size(); ++i) {
    const double step = (path.positions[i + 1] - path.positions[i]).norm();
    if (left < step || i + 2 == path.points.size()) {
      const double share = step > 0.0 ? std::clamp(left / step, 0.0, 1.0) : 0.0;
      // Both ends of the segment in the triangle that holds it.
      const SurfacePoint& end = path.points[i + 1];
      const Triangle& corners = surface.mesh.triangles[end.triangle];
      const Triangle& own = surface.mesh.triangles[path.points[i].triangle];
      Vec3 start = Vec3::Zero();
      if (path.points[i].triangle == end.triangle)
        start = path.points[i].barycentric;
      else
        for (int a = 0; a < 3; ++a)
          for (int b = 0; b < 3; ++b)
            if (own[a] == corners[b]) start[b] = path.points[i].barycentric[a];
      SurfacePoint point;
      point.triangle = end.triangle;
      point.barycentric = (1.0 - share) * start + share * end.barycentric;
      return point;
    }
    left -= step;
  }
  return path.points.empty() ? SurfacePoint() : path.points.back();
}

std::vector<SurfacePoint> resample(const Surface& surface, const Path& path, int count) {
  if (count < 2)
    throw Error("geodesic: a path is resampled to at least 2 points, not " + std::to_string(count));
  double whole = 0.0;
  for (size_t i = 0; i + 1 < path.positions.size(); ++i)
    whole += (path.positions[i + 1] - path.positions[i]).norm();
  std::vector<SurfacePoint> points;
  points.reserve(static_cast<size_t>(count));
  for (int i = 0; i < count; ++i)
    points.push_back(point_along(surface, path, whole * i / (count - 1)));
  return points;
}

}  // namespace fascia::geodesics
