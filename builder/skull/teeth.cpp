#include "builder/skull/teeth.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "builder/spatial/surface_query.h"
#include "geometry/alignment.h"

namespace fascia::skull {

TeethMatch match_teeth(const TriangleMesh& generic, const TriangleMesh& actual, const Mat4& start) {
  constexpr int samples = 400, rounds = 30;
  constexpr double kept_share = 0.8;
  const std::vector<Vec3> points = spread_points(generic, samples);
  const spatial::SurfaceQuery surface(actual);
  TeethMatch out;
  out.similarity = start;
  // Bring centres and sizes together first: the bounding boxes of two rows of teeth correspond.
  std::vector<Vec3> carried;
  for (const Vec3& p : points)
    carried.push_back(transform_point(start, p));
  const Bounds from = bounds(carried), to = bounds(actual.vertices);
  const double scale = from.size().x() > 0 ? to.size().x() / from.size().x() : 1;
  Mat4 align = Mat4::Identity();
  align.topLeftCorner<3, 3>() *= scale;
  Vec3 anchor_from = from.centre(), anchor_to = to.centre();
  anchor_from.z() = from.upper.z();  // incisors: how far back the rows reach differs between models
  anchor_to.z() = to.upper.z();
  align.topRightCorner<3, 1>() = anchor_to - scale * anchor_from;
  out.similarity = align * start;

  for (int round = 0; round < rounds; ++round) {
    std::vector<Vec3> nearest(points.size());
    std::vector<double> distance(points.size());
    for (size_t i = 0; i < points.size(); ++i) {
      const auto closest = surface.closest(transform_point(out.similarity, points[i]));
      nearest[i] = closest.position;
      distance[i] = closest.distance;
    }
    std::vector<int> order(points.size());
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(), [&](int a, int b) { return distance[a] < distance[b]; });
    order.resize(static_cast<size_t>(kept_share * static_cast<double>(order.size())));
    std::vector<Vec3> source, target;
    double sum = 0;
    for (int i : order) {
      source.push_back(transform_point(out.similarity, points[i]));
      target.push_back(nearest[i]);
      sum += distance[i] * distance[i];
    }
    out.rms = std::sqrt(sum / std::max<size_t>(1, order.size()));
    // The size is settled: nearest points would shrink it further with every round.
    const Mat4 next = rigid_motion(source, target) * out.similarity;
    const double change = (next - out.similarity).norm();
    out.similarity = next;
    if (change < 1e-9) break;
  }
  return out;
}

std::vector<Vec3> spread_points(const TriangleMesh& mesh, int count) {
  if (mesh.vertex_count() <= count) return mesh.vertices;
  std::vector<Vec3> out;
  std::vector<double> squared(mesh.vertices.size(), std::numeric_limits<double>::infinity());
  size_t next = 0;
  while (static_cast<int>(out.size()) < count) {
    out.push_back(mesh.vertices[next]);
    for (size_t v = 0; v < squared.size(); ++v)
      squared[v] = std::min(squared[v], (mesh.vertices[v] - out.back()).squaredNorm());
    next = static_cast<size_t>(std::max_element(squared.begin(), squared.end()) - squared.begin());
  }
  return out;
}

std::vector<Vec3> symmetric_points(const TriangleMesh& mesh, int count) {
  std::vector<Vec3> out;
  for (const Vec3& p : spread_points(mesh, count)) {
    out.push_back(p);
    out.push_back(Vec3(-p.x(), p.y(), p.z()));
  }
  return out;
}

}  // namespace fascia::skull
