#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>

#include "builder/spatial/triangle.h"
#include "builder/tissue/bind.h"
#include "builder/tissue/distance.h"

namespace fascia::tissue {
namespace {

using Row = std::map<uint32_t, double>;  // node -> weight, in node order

double smoothstep(double low, double high, double x) {
  const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

/// The column triangle each region vertex lies on: the best by distance and direction among those near the
/// column that is nearest along the surface.
std::vector<Row> rows_of_region(const FaceRegion& region, const Columns& c) {
  std::vector<DistanceSeed> seeds;
  for (size_t k = 0; k < c.source.size(); ++k)
    for (const int corner : region.mesh.triangles[static_cast<size_t>(c.source[k].triangle)])
      seeds.push_back({corner, (region.mesh.vertices[static_cast<size_t>(corner)] - c.mesh.vertices[k]).norm()});
  const EdgeDistances nearest = edge_distances(region.mesh, seeds);
  const auto around = triangles_around(c.mesh);
  const auto neighbours = vertex_neighbours(c.mesh);
  const std::vector<Vec3> normals = vertex_normals(region.mesh);
  std::vector<Row> rows(region.mesh.vertices.size());
  for (size_t v = 0; v < rows.size(); ++v) {
    if (nearest.seed[v] < 0) continue;
    const auto column = static_cast<size_t>(nearest.seed[v] / 3);
    std::vector<int> candidates = around[column];
    for (const int n : neighbours[column])
      candidates.insert(candidates.end(), around[static_cast<size_t>(n)].begin(), around[static_cast<size_t>(n)].end());
    std::sort(candidates.begin(), candidates.end());
    candidates.erase(std::unique(candidates.begin(), candidates.end()), candidates.end());
    double best = 1e300;
    const Vec3& p = region.mesh.vertices[v];
    for (const int t : candidates) {
      const fascia::Triangle& k = c.mesh.triangles[static_cast<size_t>(t)];
      const auto corner = [&](size_t i) -> const Vec3& { return c.mesh.vertices[static_cast<size_t>(k[i])]; };
      const Vec3 b = spatial::closest_barycentric(p, corner(0), corner(1), corner(2));
      const double size = (corner(1) - corner(0)).squaredNorm();
      const double cost = (b[0] * corner(0) + b[1] * corner(1) + b[2] * corner(2) - p).squaredNorm() +
                          0.3 * size * std::max(0.0, 0.5 - triangle_normal(c.mesh, t).dot(normals[v]));
      if (cost >= best) continue;
      best = cost;
      rows[v].clear();
      for (size_t i = 0; i < 3; ++i)
        if (b[static_cast<int>(i)] > 0.0) rows[v][static_cast<uint32_t>(k[i])] += b[static_cast<int>(i)];
    }
  }
  return rows;
}

/// Averages rows over the skin's edges, so that the coarse triangles' creases do not show.
void smooth(const TriangleMesh& mesh, const Columns& c, int passes, std::vector<Row>& rows) {
  const auto neighbours = vertex_neighbours(mesh);
  for (int pass = 0; pass < passes; ++pass) {
    std::vector<Row> next(rows.size());
    for (size_t v = 0; v < rows.size(); ++v) {
      const double count = static_cast<double>(neighbours[v].size());
      if (count == 0.0) continue;
      // Where the skin is coarser than the columns there is nothing to smooth, only detail to lose.
      double edge = 0.0, column = 0.0;
      for (const int n : neighbours[v]) edge += (mesh.vertices[static_cast<size_t>(n)] - mesh.vertices[v]).norm() / count;
      for (const auto& [node, weight] : rows[v]) column += weight * std::sqrt(c.area[node]);
      const double share = 0.5 * (1.0 - smoothstep(0.5, 1.0, edge / std::max(column, 1e-6)));
      for (const auto& [node, weight] : rows[v]) next[v][node] += (1.0 - share) * weight;
      if (share > 0.0)
        for (const int n : neighbours[v])
          for (const auto& [node, weight] : rows[static_cast<size_t>(n)]) next[v][node] += share / count * weight;
    }
    rows = std::move(next);
  }
}

/// The strongest entries, their sum kept.
Follow pack(const Row& row, double jaw) {
  std::vector<std::pair<double, uint32_t>> order;
  double total = 0.0, kept = 0.0;
  for (const auto& [node, weight] : row) {
    order.emplace_back(-weight, node);
    total += weight;
  }
  std::sort(order.begin(), order.end());
  if (order.size() > Follow::influences) order.resize(Follow::influences);
  for (const auto& [negative, node] : order) kept -= negative;
  Follow follow;
  for (size_t k = 0; k < order.size() && kept > 0.0; ++k) {
    follow.nodes[k] = order[k].second;
    follow.weights[k] = static_cast<float>(-order[k].first * total / kept);
  }
  follow.jaw = static_cast<float>(jaw);
  return follow;
}

}  // namespace

std::vector<Follow> follow_skin(const TissueInputs& inputs, const FaceRegion& region, const Columns& c) {
  std::vector<Row> rows = rows_of_region(region, c);
  smooth(region.mesh, c, 2, rows);
  std::vector<Follow> follow(inputs.skin.vertices.size());
  std::vector<DistanceSeed> edge;
  for (size_t v = 0; v < rows.size(); ++v) {
    const auto s = static_cast<size_t>(region.skin_vertex[v]);
    follow[s] = pack(rows[v], 0.0);
    if (region.opening[s] != Opening::none) edge.push_back({region.skin_vertex[v]});
  }
  // Deeper than the simulated lining: carried on from its edge.
  std::vector<bool> deep(follow.size());
  for (size_t v = 0; v < deep.size(); ++v) deep[v] = region.region_vertex[v] < 0 && region.opening[v] != Opening::none;
  const EdgeDistances beyond = edge_distances(inputs.skin, edge, 0.08, deep);
  const double teeth = 0.5 * (landmark(inputs, "cheilion_left").y() + landmark(inputs, "cheilion_right").y());
  for (size_t v = 0; v < follow.size(); ++v) {
    if (!deep[v] || beyond.seed[v] < 0) continue;
    const bool mouth = region.opening[v] == Opening::mouth;
    const double share = 1.0 - smoothstep(0.0, mouth ? 0.018 : 0.008, beyond.distance[v]);
    Follow copy = follow[static_cast<size_t>(edge[static_cast<size_t>(beyond.seed[v])].vertex)];
    for (float& weight : copy.weights) weight *= static_cast<float>(share);
    if (mouth) copy.jaw = static_cast<float>((1.0 - share) * (1.0 - smoothstep(-0.008, 0.008, inputs.skin.vertices[v].y() - teeth)));
    follow[v] = copy;
  }
  // Seeds may overlap between copies; a pass of smoothing over the deep skin evens them out.
  return follow;
}

}  // namespace fascia::tissue
