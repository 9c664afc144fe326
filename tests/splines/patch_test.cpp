// Figures 4.5 and 4.6: curvature and projection on patches of surfaces whose curvature is known.
#include "builder/splines/patch.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>

#include "geometry/error.h"
#include "tests/splines/scatter.h"

namespace fascia::splines {
namespace {

constexpr double pi = std::numbers::pi;

/// A grid of the surface `at` over [0, 1) x [0, 1), wrapped around in both directions.
template <class Surface>
TriangleMesh wrapped(int across, int along, const Surface& at) {
  TriangleMesh mesh;
  for (int i = 0; i < across; ++i)
    for (int j = 0; j < along; ++j)
      mesh.vertices.push_back(at(static_cast<double>(i) / across, static_cast<double>(j) / along));
  for (int i = 0; i < across; ++i)
    for (int j = 0; j < along; ++j) {
      const int a = i * along + j, b = (i + 1) % across * along + j;
      const int c = (i + 1) % across * along + (j + 1) % along, d = i * along + (j + 1) % along;
      mesh.triangles.push_back({a, b, c});
      mesh.triangles.push_back({a, c, d});
    }
  return mesh;
}

constexpr double ring = 1, tube = 0.4;

TriangleMesh torus(int size) {
  return wrapped(2 * size, size, [](double u, double v) {
    const double a = 2 * pi * u, b = 2 * pi * v;
    return Vec3((ring + tube * std::cos(b)) * std::cos(a), (ring + tube * std::cos(b)) * std::sin(a),
                tube * std::sin(b));
  });
}

// Largest errors of Gaussian and mean curvature over one meridian of the torus.
Vec2 torus_error(int size, const PatchOptions& options) {
  const TriangleMesh mesh = torus(size);
  const Connectivity links = connectivity(mesh);
  Vec2 worst = Vec2::Zero();
  for (int v = 0; v < size; ++v) {
    const double t = 2 * pi * v / size, w = ring + tube * std::cos(t);
    const PatchCurvature found = vertex_patch(mesh, links, v, options).curvature(Vec2::Zero());
    const double gaussian = std::cos(t) / (tube * w), mean = -0.5 * (1 / tube + std::cos(t) / w);
    worst = worst.cwiseMax(Vec2(std::abs(found.gaussian - gaussian), std::abs(found.mean - mean)));
    EXPECT_NEAR(found.gaussian, found.smallest * found.largest, 1e-9 * (1 + std::abs(found.gaussian)));
    EXPECT_NEAR(found.mean, 0.5 * (found.smallest + found.largest), 1e-9);
    EXPECT_NEAR(found.largest - found.smallest,
                2 * std::sqrt(std::max(0.0, found.mean * found.mean - found.gaussian)), 1e-6);
  }
  return worst;
}

TEST(Patch, TorusCurvatureConvergesWithTheMesh) {
  for (int jet : {0, 4}) {
    PatchOptions options;
    options.rings = 3;
    options.jet_degree = jet;
    const Vec2 coarse = torus_error(24, options), fine = torus_error(48, options);
    EXPECT_LT(fine.x(), 0.06) << "jet " << jet;
    EXPECT_LT(fine.y(), 0.02);
    EXPECT_LT(fine.x(), 0.45 * coarse.x()) << "jet " << jet;
    EXPECT_LT(fine.y(), 0.45 * coarse.y()) << "jet " << jet;
  }
}

TEST(Patch, NormalsSharpenTheCurvature) {
  // With the surface's own normals as gradients.
  std::vector<Vec3> points, normals;
  for (const Vec3& p : scattered(20, 1, true)) {
    normals.push_back(Vec3(0.4 * p.x(), 0.4 * p.y(), 1).normalized());
    points.push_back(normals.back());
  }
  points.emplace_back(0, 0, 1);
  normals.emplace_back(0, 0, 1);
  PatchOptions options;
  const double without =
      fit_patch(points, {}, {0, 0, 1}, {0, 0, 1}, options).curvature(Vec2::Zero()).gaussian;
  const double with =
      fit_patch(points, normals, {0, 0, 1}, {0, 0, 1}, options).curvature(Vec2::Zero()).gaussian;
  EXPECT_NEAR(with, 1, 0.01);
  EXPECT_LT(std::abs(with - 1), std::abs(without - 1));
}

TEST(Patch, SphereAndSaddle) {
  std::vector<Vec3> sphere, saddle;
  for (const Vec3& p : scattered(40, 2, true)) {
    sphere.push_back(3 * Vec3(0.3 * p.x(), 0.3 * p.y(), 1).normalized());
    saddle.emplace_back(p.x(), p.y(), p.x() * p.y());
  }
  sphere.emplace_back(0, 0, 3);
  const PatchCurvature ball = fit_patch(sphere, {}, {0, 0, 3}, {0, 0, 1}).curvature(Vec2::Zero());
  EXPECT_NEAR(ball.gaussian, 1.0 / 9, 1e-3);
  EXPECT_NEAR(ball.mean, -1.0 / 3, 1e-3);
  // z = xy is of the null space: exact.
  const PatchCurvature pass = fit_patch(saddle, {}, {0, 0, 0}, {0, 0, 1}).curvature(Vec2::Zero());
  EXPECT_NEAR(pass.gaussian, -1, 1e-9);
  EXPECT_NEAR(pass.mean, 0, 1e-9);
  EXPECT_NEAR(pass.smallest, -1, 1e-9);
  EXPECT_NEAR(std::abs(pass.largest_direction.normalized().z()), 0, 1e-9);
  PatchOptions jet;
  jet.jet_degree = 2;
  EXPECT_NEAR(fit_patch(saddle, {}, {0, 0, 0}, {0, 0, 1}, jet).curvature(Vec2::Zero()).gaussian, -1, 1e-12);
}

TEST(Patch, ProjectionIsWhereTheSphereTouches) {
  std::vector<Vec3> bowl;
  for (const Vec3& p : scattered(60, 3, true))
    bowl.emplace_back(p.x(), p.y(), 0.5 * p.x() * p.x() + 0.25 * p.y() * p.y());
  const Patch patch = fit_patch(bowl, {}, {0, 0, 0}, {0, 0, 1});
  for (const Vec3& p : scattered(25, 4)) {
    const Vec3 query = 0.5 * p + Vec3(0, 0, 0.3);
    const PatchFoot foot = patch.project(query);
    EXPECT_TRUE(foot.converged);
    const Vec3 gap = query - foot.position;
    EXPECT_NEAR(foot.distance, gap.norm(), 1e-15);
    // Perpendicular, and the sphere of this radius holds no other point of the patch.
    EXPECT_LT(gap.cross(patch.normal(foot.uv)).norm(), 1e-7);
    for (const Vec3& other : scattered(200, 5, true))
      EXPECT_GT((patch.position(other.head<2>()) - query).norm(), foot.distance - 1e-9);
  }
}

TEST(Patch, RingsAndBadMeshes) {
  const TriangleMesh mesh = torus(12);
  const Connectivity links = connectivity(mesh);
  EXPECT_EQ(vertex_rings(mesh, links, 30, 1).size(), 7u);
  EXPECT_EQ(vertex_rings(mesh, links, 30, 2).size(), 19u);
  EXPECT_EQ(vertex_rings(mesh, links, 30, 3).size(), 37u);
  EXPECT_THROW(vertex_rings(mesh, links, -1, 2), Error);
  TriangleMesh alone;
  alone.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  alone.triangles = {{0, 1, 2}};
  EXPECT_THROW(vertex_patch(alone, connectivity(alone), 0), Error);
  // A fin: two triangles that fold onto each other.
  alone.vertices.emplace_back(0.9, 0.1, 0);
  alone.triangles.push_back({0, 2, 3});
  alone.triangles.push_back({0, 3, 1});
  alone.triangles[0] = {0, 1, 2};
  EXPECT_THROW(vertex_patch(alone, connectivity(alone), 0), Error);
  EXPECT_THROW(fit_patch(std::vector<Vec3>(5), {}, {0, 0, 0}, {0, 0, 1}), Error);
  EXPECT_THROW(fit_patch(std::vector<Vec3>(8), {}, {0, 0, 0}, {0, 0, 1}), Error) << "points above each other";
  // A mesh's rim has half a ring only, and that is enough.
  TriangleMesh open = torus(12);
  open.triangles.resize(open.triangles.size() / 2);
  EXPECT_NO_THROW(vertex_patch(open, connectivity(open), 3));
}

}  // namespace
}  // namespace fascia::splines
