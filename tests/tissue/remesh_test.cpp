#include "builder/tissue/remesh.h"

#include <gtest/gtest.h>

#include <cmath>

#include "builder/tissue/distance.h"
#include "geometry/connectivity.h"

namespace fascia::tissue {
namespace {

constexpr double half_slit = 0.025;

/// A sheet of 100 x 80 mm with a slit along y = 0 whose two lips lie exactly upon each other.
TriangleMesh slit_sheet(double cell) {
  TriangleMesh mesh;
  const int across = static_cast<int>(std::lround(0.1 / cell)),
            half = static_cast<int>(std::lround(0.04 / cell));
  const auto add_half = [&](double sign) {
    const int first = mesh.vertex_count();
    for (int j = 0; j <= half; ++j)
      for (int i = 0; i <= across; ++i) {
        const double x = -0.05 + i * cell, y = sign * j * cell;
        mesh.vertices.push_back(Vec3(x, y, -6.0 * x * x));
      }
    const auto at = [&](int i, int j) { return first + j * (across + 1) + i; };
    for (int j = 0; j < half; ++j)
      for (int i = 0; i < across; ++i) {
        if (sign > 0) {
          mesh.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
          mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
        } else {
          mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i + 1, j)});
          mesh.triangles.push_back({at(i, j), at(i, j + 1), at(i + 1, j + 1)});
        }
      }
    return first;
  };
  const int upper = add_half(1.0), lower = add_half(-1.0);
  for (fascia::Triangle& t : mesh.triangles)  // sew the two halves outside of the slit
    for (int& v : t)
      if (v >= lower && v <= lower + across &&
          std::abs(mesh.vertices[static_cast<size_t>(v)].x()) >= half_slit)
        v = upper + v - lower;
  return mesh;
}

TEST(Remesh, LipsThatTouchNeverJoin) {
  const TriangleMesh sheet = slit_sheet(0.002);
  const RemeshResult coarse = remesh(sheet, std::vector<double>(sheet.vertices.size(), 0.006));
  const Connectivity links = connectivity(coarse.mesh);
  EXPECT_EQ(links.irregular_edges, 0);
  EXPECT_EQ(boundary_loops(coarse.mesh, links).size(), 2U);  // the rim and the slit
  for (int t = 0; t < coarse.mesh.triangle_count(); ++t) {
    const fascia::Triangle& k = coarse.mesh.triangles[static_cast<size_t>(t)];
    double low = 1.0, high = -1.0, away = 1.0;
    for (const int v : k) {
      const Vec3& p = coarse.mesh.vertices[static_cast<size_t>(v)];
      low = std::min(low, p.y());
      high = std::max(high, p.y());
      away = std::min(away, half_slit - std::abs(p.x()));
    }
    EXPECT_FALSE(away > 0.001 && low < -1e-6 && high > 1e-6) << "triangle " << t << " bridges the slit";
  }
  // Its source knows the side too.
  for (size_t v = 0; v < coarse.source.size(); ++v) {
    const fascia::Triangle& k = sheet.triangles[static_cast<size_t>(coarse.source[v].triangle)];
    double side = 0.0;
    for (const int i : k)
      side += sheet.vertices[static_cast<size_t>(i)].y();
    EXPECT_TRUE(std::abs(coarse.mesh.vertices[v].y()) < 0.001 || side * coarse.mesh.vertices[v].y() > 0.0);
  }
}

TEST(Remesh, EdgesHaveTheLengthAskedFor) {
  const TriangleMesh sheet = slit_sheet(0.002);
  std::vector<double> wanted(sheet.vertices.size());
  for (size_t v = 0; v < wanted.size(); ++v)
    wanted[v] = 0.003 + 0.1 * std::abs(sheet.vertices[v].y());
  const RemeshResult result = remesh(sheet, wanted);
  double worst = 0.0, mean = 0.0;
  int count = 0, poor = 0;
  for (const fascia::Triangle& t : result.mesh.triangles)
    for (size_t e = 0; e < 3; ++e) {
      const Vec3 &a = result.mesh.vertices[static_cast<size_t>(t[e])],
                 &b = result.mesh.vertices[static_cast<size_t>(t[(e + 1) % 3])];
      const double ratio = (a - b).norm() / (0.003 + 0.05 * (std::abs(a.y()) + std::abs(b.y())));
      worst = std::max(worst, ratio);
      mean += ratio;
      poor += ratio < 0.5 ? 1 : 0;
      ++count;
    }
  EXPECT_LT(worst, 1.6);
  EXPECT_NEAR(mean / count, 0.95, 0.15);
  EXPECT_LT(poor, count / 50);
  for (const SurfacePoint& p : result.source)
    EXPECT_NEAR(p.barycentric.sum(), 1.0, 1e-9);
}

TEST(Remesh, ScaleMeetsTheWantedCount) {
  const TriangleMesh sheet = slit_sheet(0.002);
  std::vector<double> wanted(sheet.vertices.size(), 0.004);
  const double scale = edge_scale_for(sheet, wanted, 500);
  for (double& w : wanted)
    w *= scale;
  EXPECT_NEAR(remesh(sheet, wanted).mesh.vertex_count(), 500, 100);
}

TEST(Distance, AcrossTheSlitIsTheWayAround) {
  const TriangleMesh sheet = slit_sheet(0.002);
  int above = -1, below = -1;
  for (int v = 0; v < sheet.vertex_count(); ++v) {
    const Vec3& p = sheet.vertices[static_cast<size_t>(v)];
    if (std::abs(p.x()) < 1e-9 && std::abs(p.y() - 0.002) < 1e-9) above = v;
    if (std::abs(p.x()) < 1e-9 && std::abs(p.y() + 0.002) < 1e-9) below = v;
  }
  const EdgeDistances d = edge_distances(sheet, {{above}});
  EXPECT_GT(d.distance[static_cast<size_t>(below)], 2 * half_slit);
  EXPECT_LT(d.distance[static_cast<size_t>(below)], 2.5 * half_slit);
}

}  // namespace
}  // namespace fascia::tissue
