#include "builder/geodesics/loop.h"

#include <algorithm>

#include "builder/geodesics/strip.h"
#include "geometry/error.h"

namespace fascia::geodesics {

namespace {

/// `point` moved off its triangle's edges, by a length that no result shows.
SurfacePoint inside(const SurfacePoint& point) {
  SurfacePoint moved = point;
  if (point.barycentric.minCoeff() < 1e-9)
    moved.barycentric = (1.0 - 3e-9) * point.barycentric + Vec3::Constant(1e-9);
  return moved;
}

/// Crossings of the polygon through `corners`, once around.
std::vector<int> polygon_strip(const Surface& surface, const std::vector<SurfacePoint>& corners,
                               const PathOptions& options, Workspace& workspace) {
  std::vector<int> strip;
  Path side;
  for (size_t i = 0; i < corners.size(); ++i) {
    connect_into(surface, corners[i], corners[(i + 1) % corners.size()], options, workspace, side);
    // The strip was laid from the first of the two in the order of points: see which end it starts at.
    std::vector<int> part = workspace.strip;
    if (!part.empty() && part[0] / 3 != corners[i].triangle) turn_strip(surface, part);
    for (int h : part)
      push_crossing(surface, strip, h);
  }
  return strip;
}

/// Cancels crossings at the end of a cyclic strip that undo those at its start.
void reduce_ends(const Surface& surface, std::vector<int>& strip) {
  size_t cut = 0;
  while (strip.size() >= 2 * (cut + 1) && surface.twin[strip[strip.size() - 1 - cut]] == strip[cut])
    ++cut;
  strip.resize(strip.size() - cut);
  strip.erase(strip.begin(), strip.begin() + static_cast<std::ptrdiff_t>(cut));
}

void rotate_strip(std::vector<int>& strip, int start) {
  std::rotate(strip.begin(), strip.begin() + start % static_cast<int>(strip.size()), strip.end());
}

/// The middle of segment `i` of `path`, inside its triangle.
SurfacePoint segment_middle(const Surface& surface, const Path& path, size_t i) {
  SurfacePoint point = path.points[i + 1];
  const SurfacePoint& other = path.points[i];
  Vec3 start = Vec3::Zero();
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b)
      if (surface.mesh.triangles[other.triangle][a] == surface.mesh.triangles[point.triangle][b])
        start[b] = other.barycentric[a];
  point.barycentric = 0.5 * (point.barycentric + start);
  return inside(point);
}

}  // namespace

LoopResult tighten_loop(const Surface& surface, const std::vector<SurfacePoint>& corners,
                        const LoopOptions& options) {
  if (corners.size() < 3)
    throw Error("geodesic loop: " + std::to_string(corners.size()) + " corners; a loop needs at least 3");
  std::vector<SurfacePoint> polygon;
  for (const SurfacePoint& corner : corners)
    polygon.push_back(inside(checked(surface, corner)));
  Workspace workspace;
  std::vector<int> strip = polygon_strip(surface, polygon, options.path, workspace);
  reduce_ends(surface, strip);
  LoopResult result;
  SurfacePoint anchor = polygon[0];
  double shortest = 1e300;
  int without_gain = 0;
  while (result.rounds < options.maximum_rounds && without_gain < 3) {
    if (strip.empty()) {
      result.contracted = true;
      result.path = Path();
      result.path.points.assign(2, anchor);
      result.path.positions.assign(2, position(surface.mesh, anchor));
      return result;
    }
    // The anchor must lie in the triangle where the strip begins and ends.
    if (strip[0] / 3 != anchor.triangle) anchor = inside(point_on_edge(strip[0], 0.5));
    workspace.strip = strip;
    result.path.counters = PathCounters();
    straighten_strip(surface, anchor, anchor, options.path, workspace, result.path);
    ++result.rounds;
    without_gain = result.path.length < shortest * (1.0 - options.gain_tolerance) ? 0 : without_gain + 1;
    shortest = std::min(shortest, result.path.length);
    strip = workspace.strip;
    if (strip.empty()) continue;
    const size_t segments = result.path.points.size() - 1;
    // Opposite the last anchor, then a quarter further: no symmetry keeps both anchors in place.
    const size_t segment = result.rounds % 2 == 1 ? segments / 2 : segments / 4;
    if (without_gain < 3) {
      anchor = segment_middle(surface, result.path, segment);
      rotate_strip(strip, workspace.point_crossing[segment + 1]);
    }
    reduce_ends(surface, strip);
  }
  return result;
}

}  // namespace fascia::geodesics
