#include "builder/landmarks/round_parts.h"

#include <algorithm>
#include <cmath>

#include "builder/landmarks/spheres.h"
#include "geometry/connectivity.h"
#include "geometry/disjoint_sets.h"

namespace fascia::landmarks {

namespace {

/// The part of each triangle of `mesh`, by shared edges: an eyeball that touches its lids in a vertex is a
/// part of its own.
std::vector<int> parts_by_edges(const TriangleMesh& mesh, int* count) {
  DisjointSets sets(mesh.triangles.size());
  const std::vector<HalfEdge> edges = sorted_half_edges(mesh.triangles, mesh.vertices.size());
  for (size_t e = 1; e < edges.size(); ++e)
    if (edges[e].low == edges[e - 1].low && edges[e].high == edges[e - 1].high)
      sets.join(edges[e].triangle, edges[e - 1].triangle);
  std::vector<int> part(mesh.triangles.size(), -1);
  *count = 0;
  for (size_t t = 0; t < part.size(); ++t) {
    const auto first = static_cast<size_t>(sets.of(static_cast<int>(t)));  // no later than `t`
    part[t] = first == t ? (*count)++ : part[first];
  }
  return part;
}

}  // namespace

std::vector<Ball> round_parts(const TriangleMesh& mesh) {
  const double extent = bounds(mesh.vertices).size().norm();
  const TriangleMesh welded = weld(mesh, 1e-6 * extent, nullptr);
  int count = 0;
  const std::vector<int> component = parts_by_edges(welded, &count);
  std::vector<std::vector<int>> members(static_cast<size_t>(count));
  for (size_t t = 0; t < component.size(); ++t)
    for (int v : welded.triangles[t])
      members[static_cast<size_t>(component[t])].push_back(v);
  std::vector<Ball> balls;
  for (std::vector<int>& part : members) {
    std::sort(part.begin(), part.end());
    part.erase(std::unique(part.begin(), part.end()), part.end());
    if (part.size() < 16 || part.size() > 20000) continue;
    std::vector<Vec3> points;
    for (int v : part)
      points.push_back(welded.vertices[static_cast<size_t>(v)]);
    const Ball ball = fit_ball(points);
    double sum = 0.0;
    for (const Vec3& p : points)
      sum += std::pow((p - ball.centre).norm() - ball.radius, 2);
    const double rms = std::sqrt(sum / static_cast<double>(points.size()));
    const bool is_ball = ball.radius > 0.0 && rms < 0.08 * ball.radius &&
                         bounds(points).size().maxCoeff() > 0.9 * ball.radius && ball.radius < 0.25 * extent;
    if (is_ball) balls.push_back(ball);
  }
  return balls;
}

std::vector<Ball> round_holes(const TriangleMesh& mesh) {
  const double extent = bounds(mesh.vertices).size().norm();
  const TriangleMesh welded = weld(mesh, 1e-6 * extent, nullptr);
  std::vector<Ball> holes;
  for (const std::vector<int>& loop : boundary_loops(welded, connectivity(welded))) {
    if (loop.size() < 6) continue;
    Vec3 middle = Vec3::Zero();
    double radius = 0.0, uneven = 0.0;
    const auto count = static_cast<double>(loop.size());
    for (int v : loop)
      middle += welded.vertices[static_cast<size_t>(v)] / count;
    for (int v : loop)
      radius += (welded.vertices[static_cast<size_t>(v)] - middle).norm() / count;
    for (int v : loop)
      uneven += std::abs((welded.vertices[static_cast<size_t>(v)] - middle).norm() - radius) / count;
    if (uneven < 0.3 * radius && radius < 0.15 * extent) holes.push_back({middle, radius});
  }
  return holes;
}

}  // namespace fascia::landmarks
