#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include "builder/spatial/surface_query.h"
#include "builder/spatial/triangle.h"
#include "builder/tissue/bind.h"
#include "builder/tissue/distance.h"
#include "builder/tissue/laplacian.h"
#include "geometry/smoothstep.h"

namespace fascia::tissue {
namespace {

/// The column triangle each region vertex lies on: the best by distance and direction among those near the
/// column that is nearest along the surface.
std::vector<Row> rows_of_region(const FaceRegion& region, const Columns& c) {
  std::vector<DistanceSeed> seeds;
  for (size_t k = 0; k < c.source.size(); ++k)
    for (const int corner : region.mesh.triangles[static_cast<size_t>(c.source[k].triangle)])
      seeds.push_back(
          {corner, (region.mesh.vertices[static_cast<size_t>(corner)] - c.mesh.vertices[k]).norm()});
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
      candidates.insert(candidates.end(), around[static_cast<size_t>(n)].begin(),
                        around[static_cast<size_t>(n)].end());
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
      for (const int n : neighbours[v])
        edge += (mesh.vertices[static_cast<size_t>(n)] - mesh.vertices[v]).norm() / count;
      for (const auto& [node, weight] : rows[v])
        column += weight * std::sqrt(c.area[node]);
      const double share = 0.5 * (1.0 - smoothstep(0.5, 1.0, edge / std::max(column, 1e-6)));
      for (const auto& [node, weight] : rows[v])
        next[v][node] += (1.0 - share) * weight;
      if (share > 0.0)
        for (const int n : neighbours[v])
          for (const auto& [node, weight] : rows[static_cast<size_t>(n)])
            next[v][node] += share / count * weight;
    }
    rows = std::move(next);
  }
}

/// How far the rows are evened out at each vertex, metres: at the corners of the mouth and the edges of the
/// lids.
std::vector<double> easing(const TissueInputs& inputs, const FaceRegion& region) {
  const Vec3 corners[] = {landmark(inputs, "cheilion_left"), landmark(inputs, "cheilion_right")};
  constexpr double at_corners = 0.0015, corner_begin = 0.010, corner_end = 0.018;  // metres
  constexpr double at_lids = 0.0007, lid_begin = 0.003, lid_end = 0.008;
  std::vector<double> lengths(region.mesh.vertices.size());
  for (size_t v = 0; v < lengths.size(); ++v) {
    const Vec3& p = region.mesh.vertices[v];
    const double corner = std::min((p - corners[0]).norm(), (p - corners[1]).norm());
    const double lid = std::min(region.opening_distance[static_cast<size_t>(Opening::eye_left)][v],
                                region.opening_distance[static_cast<size_t>(Opening::eye_right)][v]);
    lengths[v] = std::max(at_corners * (1.0 - smoothstep(corner_begin, corner_end, corner)),
                          at_lids * (1.0 - smoothstep(lid_begin, lid_end, lid)));
  }
  return lengths;
}

/// Evens out rows along the surface over `reach` (metres, #vertices): at the corners of the mouth a few
/// tenths of a millimetre of skin span what opens by centimetres, and across the lattice's few triangles
/// there the skin would turn over at every crease.
void ease(const TriangleMesh& mesh, const std::vector<double>& reach, std::vector<Row>& rows) {
  std::vector<bool> keep(mesh.triangles.size());
  for (size_t t = 0; t < keep.size(); ++t)
    keep[t] = std::any_of(mesh.triangles[t].begin(), mesh.triangles[t].end(),
                          [&](int v) { return reach[static_cast<size_t>(v)] > 0.0; });
  std::vector<int> patch_vertex;
  const TriangleMesh patch = submesh(mesh, keep, &patch_vertex);
  if (patch.empty()) return;
  std::vector<size_t> vertex(patch.vertices.size());
  std::vector<double> lengths(patch.vertices.size());
  std::map<uint32_t, Eigen::Index> column;
  for (size_t v = 0; v < rows.size(); ++v) {
    if (patch_vertex[v] < 0) continue;
    const auto at = static_cast<size_t>(patch_vertex[v]);
    vertex[at] = v;
    lengths[at] = reach[v];
    for (const auto& entry : rows[v])
      column.emplace(entry.first, 0);
  }
  Eigen::Index count = 0;
  for (auto& entry : column)
    entry.second = count++;
  Eigen::MatrixXd weights = Eigen::MatrixXd::Zero(patch.vertex_count(), count);
  for (size_t at = 0; at < vertex.size(); ++at)
    for (const auto& [node, weight] : rows[vertex[at]])
      weights(static_cast<Eigen::Index>(at), column.at(node)) = weight;
  SurfaceSmoother(patch, lengths).smooth(weights);
  for (size_t at = 0; at < vertex.size(); ++at) {
    const auto even =
        weights.row(static_cast<Eigen::Index>(at)).unaryExpr([](double w) { return w > 1e-4 ? w : 0.0; });
    const double kept = even.sum(), whole = weights.row(static_cast<Eigen::Index>(at)).sum();
    Row row;
    for (const auto& [node, k] : column)
      if (even[k] > 0.0) row[node] = even[k] * whole / kept;
    rows[vertex[at]] = std::move(row);
  }
}

void add(const Row& from, double share, Row& to) {
  for (const auto& [node, weight] : from)
    to[node] += share * weight;
}

/// Shifts the first weights of a row that lost its others so that it stands where it stood, in multiples of
/// themselves: neighbours whose rows were cut at different entries keep moving alike.
void keep_place(const std::vector<std::pair<double, uint32_t>>& entries, size_t kept,
                const std::vector<Vec3>& places, std::vector<double>& weights) {
  Eigen::Matrix4d moments = Eigen::Matrix4d::Zero();
  Eigen::Vector4d lost = Eigen::Vector4d::Zero();
  const Vec3 origin = places[entries[0].second];
  for (size_t k = 0; k < entries.size(); ++k) {
    Eigen::Vector4d at;
    at << 1.0, (places[entries[k].second] - origin) / 0.002;
    if (k < kept)
      moments += weights[k] * at * at.transpose();
    else
      lost -= entries[k].first * at;
  }
  moments += 1e-3 * Eigen::Vector4d(1e-6, 1.0, 1.0, 1.0)
                        .asDiagonal()
                        .toDenseMatrix();  // columns in one plane say nothing off it
  const Eigen::Vector4d share = moments.ldlt().solve(lost);
  double sum = 0.0, wanted = 0.0;
  for (const auto& entry : entries)
    wanted -= entry.first;
  for (size_t k = 0; k < kept; ++k) {
    Eigen::Vector4d at;
    at << 1.0, (places[entries[k].second] - origin) / 0.002;
    weights[k] *= std::max(0.0, 1.0 + share.dot(at));
    sum += weights[k];
  }
  for (double& weight : weights)
    weight *= wanted / std::max(sum, 1e-12);
}

/// How much of the lattice's motion each vertex of the region takes: none in the lower band of the neck and
/// all around the face, where what is not simulated begins or another mesh may join on.
std::vector<double> share_from_rim(const FaceRegion& region) {
  constexpr double still = 0.004, full = 0.014;  // metres from the rim
  std::vector<DistanceSeed> rim;
  for (size_t v = 0; v < region.rim.size(); ++v)
    if (region.rim[v]) rim.push_back({static_cast<int>(v)});
  std::vector<double> share = surface_distances(region.mesh, rim, 2.0 * full).distance;
  for (double& value : share)
    value = smoothstep(still, full, value);
  return share;
}

/// What lies deeper in the mouth than the simulated lining: the walls of the vestibule go with the cheek or
/// lip in front of them, the rest with palate or jaw by its height, and nothing moves far down the throat.
class DeepMouth {
 public:
  DeepMouth(const TissueInputs& inputs, const FaceRegion& region, const std::vector<Row>& rows)
      : rows_(rows),
        normals_(vertex_normals(inputs.skin)),
        height_(0.5 * (landmark(inputs, "cheilion_left").y() + landmark(inputs, "cheilion_right").y())) {
    outer_.vertices = region.mesh.vertices;
    for (const fascia::Triangle& t : region.mesh.triangles)
      if (region.outer[static_cast<size_t>(t[0])] && region.outer[static_cast<size_t>(t[1])] &&
          region.outer[static_cast<size_t>(t[2])])
        outer_.triangles.push_back(t);
    if (!outer_.empty()) query_.emplace(outer_);
  }

  /// The row of skin vertex `v` at `p`, so far along the surface from the lining's edge.
  Row row(size_t v, const Vec3& p, double distance) const {
    constexpr double range = 0.02, skip = 2e-4;    // metres along a ray
    constexpr double thin = 0.009, thick = 0.018;  // metres: surely, surely not the wall of lip or cheek
    constexpr double between_jaws = 0.008;         // metres from the mouth's height
    constexpr double throat_begin = 0.02, throat_end = 0.065;  // metres from the lining's edge
    Row row;
    const auto hit =
        query_ && !normals_[v].isZero() ? query_->first_hit(p, -normals_[v], range, skip) : std::nullopt;
    const double wall = hit ? 1.0 - smoothstep(thin, thick, hit->distance) : 0.0;
    if (wall > 0.0)
      for (int k = 0; k < 3; ++k)
        add(rows_[static_cast<size_t>(
                outer_.triangles[static_cast<size_t>(hit->surface.triangle)][static_cast<size_t>(k)])],
            wall * hit->surface.barycentric[k], row);
    const double jaw = (1.0 - smoothstep(-between_jaws, between_jaws, p.y() - height_)) *
                       (1.0 - smoothstep(throat_begin, throat_end, distance));
    if (jaw > 0.0) row[jaw_entry] += (1.0 - wall) * jaw;
    return row;
  }

 private:
  const std::vector<Row>& rows_;
  std::vector<Vec3> normals_;
  double height_;
  TriangleMesh outer_;
  std::optional<spatial::SurfaceQuery> query_;
};

/// Evens out the rows of `deep` vertices over the skin's edges; the others stand.
void smooth_deep(const std::vector<std::vector<int>>& neighbours, const std::vector<bool>& deep, int passes,
                 std::vector<Row>& rows) {
  for (int pass = 0; pass < passes; ++pass) {
    std::vector<std::pair<size_t, Row>> changed;
    for (size_t v = 0; v < rows.size(); ++v) {
      if (!deep[v] || neighbours[v].empty()) continue;
      Row next;
      add(rows[v], 0.5, next);
      for (const int n : neighbours[v])
        add(rows[static_cast<size_t>(n)], 0.5 / static_cast<double>(neighbours[v].size()), next);
      std::erase_if(next, [](const auto& entry) { return entry.second < 1e-4; });
      changed.emplace_back(v, std::move(next));
    }
    for (auto& [v, row] : changed)
      rows[v] = std::move(row);
  }
}

}  // namespace

Follow pack(const Row& row, const std::vector<Vec3>& places) {
  std::vector<std::pair<double, uint32_t>> order;
  Follow follow;
  for (const auto& [node, weight] : row) {
    if (node == jaw_entry)
      follow.jaw = static_cast<float>(weight);
    else
      order.emplace_back(-weight, node);
  }
  std::sort(order.begin(), order.end());
  const size_t kept = std::min(order.size(), Follow::influences);
  std::vector<double> weights;
  for (size_t k = 0; k < kept; ++k)
    weights.push_back(-order[k].first);
  if (kept < order.size()) keep_place(order, kept, places, weights);
  for (size_t k = 0; k < kept; ++k) {
    follow.nodes[k] = order[k].second;
    follow.weights[k] = static_cast<float>(weights[k]);
  }
  return follow;
}

std::vector<Follow> follow_skin(const TissueInputs& inputs, const FaceRegion& region, const Columns& c) {
  std::vector<Row> rows = rows_of_region(region, c);
  smooth(region.mesh, c, 2, rows);
  ease(region.mesh, easing(inputs, region), rows);
  std::vector<Row> skin(inputs.skin.vertices.size());
  std::vector<DistanceSeed> edge;
  const std::vector<double> share = share_from_rim(region);
  for (size_t v = 0; v < rows.size(); ++v) {
    const auto s = static_cast<size_t>(region.skin_vertex[v]);
    add(rows[v], share[v], skin[s]);
    if (region.opening[s] != Opening::none) edge.push_back({region.skin_vertex[v]});
  }
  // Deeper than the simulated lining: carried on from its edge, over so many metres.
  constexpr double over_mouth = 0.018, over_others = 0.008;
  std::vector<bool> deep(skin.size()), deep_mouth(skin.size());
  for (size_t v = 0; v < deep.size(); ++v)
    deep[v] = region.region_vertex[v] < 0 && region.opening[v] != Opening::none;
  const EdgeDistances beyond = edge_distances(inputs.skin, edge, 0.15, deep);
  const DeepMouth mouth(inputs, region, rows);
  for (size_t v = 0; v < skin.size(); ++v) {
    if (!deep[v] || beyond.seed[v] < 0) continue;
    deep_mouth[v] = region.opening[v] == Opening::mouth;
    const double lining = 1.0 - smoothstep(0.0, deep_mouth[v] ? over_mouth : over_others, beyond.distance[v]);
    add(skin[static_cast<size_t>(edge[static_cast<size_t>(beyond.seed[v])].vertex)], lining, skin[v]);
    if (deep_mouth[v]) add(mouth.row(v, inputs.skin.vertices[v], beyond.distance[v]), 1.0 - lining, skin[v]);
  }
  smooth_deep(vertex_neighbours(inputs.skin), deep_mouth, 10, skin);
  std::vector<Follow> follow(skin.size());
  for (size_t v = 0; v < skin.size(); ++v)
    follow[v] = pack(skin[v], c.mesh.vertices);
  return follow;
}

}  // namespace fascia::tissue
