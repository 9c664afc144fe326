#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "builder/tissue/distance.h"
#include "builder/tissue/laplacian.h"

namespace fascia::tissue {
namespace {

/// A flat square of 40 mm whose inner vertices are shaken by a third of a cell; the lower edge stays
/// straight.
TriangleMesh shaken_square(int cells, double shake) {
  TriangleMesh mesh;
  const double cell = 0.04 / cells;
  uint32_t state = 7;
  const auto noise = [&] {
    state = 1664525U * state + 1013904223U;
    return static_cast<double>(state >> 8) / 8388608.0 - 1.0;
  };
  for (int j = 0; j <= cells; ++j)
    for (int i = 0; i <= cells; ++i) {
      const bool inside = i > 0 && j > 0 && i < cells && j < cells;
      const double x = noise(), y = noise();
      mesh.vertices.push_back(cell *
                              Vec3(i + (inside ? shake * x : 0.0), j + (inside ? shake * y : 0.0), 0.0));
    }
  for (int j = 0; j < cells; ++j)
    for (int i = 0; i < cells; ++i) {
      const int a = j * (cells + 1) + i, b = a + 1, c = a + cells + 1, d = c + 1;
      mesh.triangles.push_back({a, b, d});
      mesh.triangles.push_back({a, d, c});
    }
  return mesh;
}

TEST(SurfaceDistance, FromALineItIsTheHeight) {
  for (const double shake : {0.0, 0.3}) {
    const TriangleMesh mesh = shaken_square(20, shake);
    std::vector<DistanceSeed> line;
    for (int i = 0; i <= 20; ++i)
      line.push_back({i});
    const EdgeDistances d = surface_distances(mesh, line), along_edges = edge_distances(mesh, line);
    double excess = 0.0, edge_excess = 0.0;
    for (size_t v = 0; v < mesh.vertices.size(); ++v) {
      const double height = mesh.vertices[v].y();
      EXPECT_GE(d.distance[v], height - 1e-12);
      EXPECT_NEAR(d.distance[v], height, shake > 0.0 ? 0.001 : 1e-12)
          << v;  // half a cell: past obtuse corners it goes along edges
      excess += d.distance[v] - height;
      edge_excess += along_edges.distance[v] - height;
    }
    EXPECT_LE(excess, 0.4 * edge_excess + 1e-9) << "edges " << edge_excess;
  }
}

TEST(SurfaceDistance, FromAPointItIsNearlyStraightAndNeverShorter) {
  const TriangleMesh mesh = shaken_square(40, 0.3);
  const EdgeDistances d = surface_distances(mesh, {{0}}), along_edges = edge_distances(mesh, {{0}});
  double excess = 0.0, edge_excess = 0.0;
  for (size_t v = 1; v < mesh.vertices.size(); ++v) {
    const double straight = mesh.vertices[v].norm();
    EXPECT_GE(d.distance[v], straight - 1e-12);
    EXPECT_LE(d.distance[v], along_edges.distance[v] + 1e-12);
    excess = std::max(excess, d.distance[v] / straight - 1.0);
    edge_excess = std::max(edge_excess, along_edges.distance[v] / straight - 1.0);
  }
  EXPECT_LT(excess, 0.08);
  EXPECT_LT(excess, 0.7 * edge_excess);
}

TEST(SurfaceDistance, StopsAtItsRangeAndAtWhatIsNotAllowed) {
  const TriangleMesh mesh = shaken_square(20, 0.0);
  std::vector<bool> allowed(mesh.vertices.size(), true);
  for (size_t v = 0; v < allowed.size(); ++v)
    allowed[v] = mesh.vertices[v].y() < 0.0101 || mesh.vertices[v].y() > 0.0159;
  const EdgeDistances d = surface_distances(mesh, {{0}}, 0.02, allowed);
  for (size_t v = 0; v < mesh.vertices.size(); ++v) {
    if (mesh.vertices[v].y() > 0.0101 || mesh.vertices[v].norm() > 0.021) {
      EXPECT_EQ(d.seed[v], -1);
      EXPECT_TRUE(std::isinf(d.distance[v]));
    } else if (mesh.vertices[v].norm() < 0.018) {
      EXPECT_EQ(d.seed[v], 0);
    }
  }
}

TEST(SurfaceSmoother, KeepsConstantsAndTheSumAndFlattensAWaveByItsClosedForm) {
  const TriangleMesh mesh = shaken_square(60, 0.25);
  const double length = 0.002, wave = 2.0 * 3.14159265358979 / 0.02;
  const SurfaceSmoother smoother(mesh, std::vector<double>(mesh.vertices.size(), length));
  const std::vector<double> areas = vertex_areas(mesh);
  std::vector<double> ones(mesh.vertices.size(), 3.0), cosine(ones.size());
  for (size_t v = 0; v < cosine.size(); ++v)
    cosine[v] = std::cos(wave * mesh.vertices[v].x());
  double before = 0.0, after = 0.0;
  for (size_t v = 0; v < areas.size(); ++v)
    before += areas[v] * cosine[v];
  smoother.smooth(ones);
  smoother.smooth(cosine);
  const double share = 1.0 / (1.0 + length * length * wave * wave);  // of (1 - length^2 Laplacian) u = cosine
  for (size_t v = 0; v < areas.size(); ++v) {
    after += areas[v] * cosine[v];
    EXPECT_NEAR(ones[v], 3.0, 1e-5);
    EXPECT_NEAR(cosine[v], share * std::cos(wave * mesh.vertices[v].x()), 0.03);
  }
  EXPECT_NEAR(before, after, 1e-7);
}

}  // namespace
}  // namespace fascia::tissue
