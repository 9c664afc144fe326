#include "builder/smas/marching_triangles.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstring>

#include "builder/smas/surface_quality.h"
#include "geometry/connectivity.h"
#include "geometry/error.h"

namespace fascia::smas {
namespace {

double sphere(const Vec3& p, Vec3* gradient) {
  const double r = p.norm();
  if (gradient) *gradient = p / r;
  return r - 1.0;
}

// Torus about z, radii 1 and .4.
double torus(const Vec3& p, Vec3* gradient) {
  const double ring = std::hypot(p[0], p[1]), tube = std::hypot(ring - 1.0, p[2]);
  if (gradient) *gradient = Vec3((ring - 1.0) * p[0] / ring, (ring - 1.0) * p[1] / ring, p[2]) / tube;
  return tube - 0.4;
}

// Three Gaussian blobs; negative inside.
double blobs(const Vec3& p, Vec3* gradient) {
  const Vec3 centres[] = {Vec3(-0.9, 0, 0), Vec3(0.9, 0.1, 0), Vec3(0.1, 1.2, 0.2)};
  double f = 0.3;
  Vec3 g = Vec3::Zero();
  for (const Vec3& c : centres) {
    const double w = std::exp(-(p - c).squaredNorm());
    f -= w;
    g += 2.0 * w * (p - c);
  }
  if (gradient) *gradient = g;
  return f;
}

// Ellipsoid of half axes 1, 1 and .25: flat at the poles, radius of curvature 1/16 at the rim.
double lens(const Vec3& p, Vec3* gradient) {
  const Vec3 g(p[0], p[1], 16.0 * p[2]);
  if (gradient) *gradient = g;
  return 0.5 * (p.dot(g) - 1.0);
}

int euler(const TriangleMesh& mesh) {
  const Connectivity links = connectivity(mesh);
  int edges = 0;
  for (const auto& neighbours : links.neighbours)
    for (int n : neighbours)
      edges += n < 0 ? 2 : 1;
  return mesh.vertex_count() - edges / 2 + mesh.triangle_count();
}

void expect_sound(const MarchingResult& result, const ImplicitFunction& f, double tolerance) {
  EXPECT_EQ(connectivity(result.mesh).irregular_edges, 0);
  std::vector<bool> used(result.mesh.vertices.size(), false);
  for (int t = 0; t < result.mesh.triangle_count(); ++t) {
    Vec3 facing = Vec3::Zero();
    for (int v : result.mesh.triangles[t])
      used[v] = true, facing += result.normals[v];
    EXPECT_GT(triangle_normal(result.mesh, t).dot(facing), 0.0);
  }
  for (size_t v = 0; v < used.size(); ++v) {
    EXPECT_TRUE(used[v]);
    Vec3 gradient;
    const double value = f(result.mesh.vertices[v], &gradient);
    EXPECT_LT(std::abs(value) / gradient.norm(), tolerance);
    EXPECT_GT(gradient.normalized().dot(result.normals[v]), 0.999);
  }
}

MarchingOptions with(double length, std::vector<Vec3> seeds) {
  MarchingOptions options;
  options.edge_length = length;
  options.seeds = std::move(seeds);
  return options;
}

TEST(MarchingTriangles, SphereHasThePredictedCountSagAndGenus) {
  // 4 pi / (sqrt(3)/4 L^2) = 2902 equilateral triangles cover the unit sphere at L = .1.
  for (const bool improve : {false, true}) {
    MarchingOptions options = with(0.1, {Vec3(1.2, 0.1, 0.0)});
    options.improve = improve;
    const MarchingResult result = marching_triangles(sphere, options);
    expect_sound(result, sphere, 1e-6);
    EXPECT_NEAR(result.mesh.triangle_count(), 2902, 290);
    EXPECT_EQ(euler(result.mesh), 2);
    EXPECT_EQ(result.boundary_edges, 0);
    EXPECT_EQ(result.parts, 1);
    double sag = 0.0;
    for (const Triangle& t : result.mesh.triangles)
      sag +=
          1.0 - ((result.mesh.vertices[t[0]] + result.mesh.vertices[t[1]] + result.mesh.vertices[t[2]]) / 3.0)
                    .norm();
    EXPECT_NEAR(sag / result.mesh.triangle_count(), 0.1 * 0.1 / 6.0, 0.3 * 0.1 * 0.1 / 6.0);
    EXPECT_LT(result.evaluations, (improve ? 5 : 3) * result.mesh.vertex_count());
  }
}

TEST(MarchingTriangles, TrianglesAreNearEquilateral) {
  for (double length : {0.3, 0.1, 0.037}) {
    const TriangleQuality quality =
        triangle_quality(marching_triangles(sphere, with(length, {Vec3(0, 0, 1)})).mesh);
    EXPECT_GE(quality.min_angle, 25.0) << length;
    EXPECT_GE(quality.mean_min_angle, 50.0) << length;
    EXPECT_GE(quality.mean_radius_ratio, 0.92) << length;
  }
}

TEST(MarchingTriangles, TorusHasGenusOne) {
  for (double length : {0.15, 0.1, 0.06, 0.04}) {
    const MarchingResult result = marching_triangles(torus, with(length, {Vec3(1.4, 0, 0)}));
    expect_sound(result, torus, 1e-6);
    EXPECT_EQ(euler(result.mesh), 0) << length;
    EXPECT_EQ(result.boundary_edges, 0) << length;
    const double expected = 4.0 * M_PI * M_PI * 0.4 / (std::sqrt(3.0) / 4.0 * length * length);
    EXPECT_NEAR(result.mesh.triangle_count(), expected, 0.12 * expected);
    EXPECT_GE(triangle_quality(result.mesh).min_angle, 25.0) << length;
  }
}

TEST(MarchingTriangles, BlobsFoundFromAGridOfSeeds) {
  Bounds box{Vec3(-3, -3, -3), Vec3(3, 3, 3)};
  const MarchingResult result = marching_triangles(blobs, with(0.1, grid_seeds(blobs, box, 0.25)));
  expect_sound(result, blobs, 1e-6);
  EXPECT_EQ(result.boundary_edges, 0);
  EXPECT_EQ(euler(result.mesh), 2 * result.parts);
  EXPECT_GE(triangle_quality(result.mesh).min_angle, 25.0);
  EXPECT_GE(triangle_quality(result.mesh).mean_min_angle, 50.0);
}

TEST(MarchingTriangles, NearSheetsDoNotJoin) {
  // Two spheres .02 apart, and two nested ones .03 apart: a fraction of an edge length.
  const ImplicitFunction pair = [](const Vec3& p, Vec3* gradient) {
    const Vec3 left = p - Vec3(-1.01, 0, 0), right = p - Vec3(1.01, 0, 0);
    const Vec3& nearest = left.norm() < right.norm() ? left : right;
    if (gradient) *gradient = nearest.normalized();
    return nearest.norm() - 1.0;
  };
  const MarchingResult spheres = marching_triangles(pair, with(0.1, {Vec3(-2, 0.1, 0), Vec3(2, 0.1, 0)}));
  expect_sound(spheres, pair, 1e-6);
  EXPECT_EQ(spheres.parts, 2);
  EXPECT_EQ(euler(spheres.mesh), 4);
  EXPECT_EQ(spheres.boundary_edges, 0);

  const ImplicitFunction shells = [](const Vec3& p, Vec3* gradient) {
    const double r = p.norm();
    if (gradient) *gradient = p / r * (r > 1.0 ? 1.0 : -1.0);
    return std::abs(r - 1.0) - 0.015;
  };
  const MarchingResult nested = marching_triangles(shells, with(0.1, {Vec3(1.02, 0, 0), Vec3(0.98, 0, 0)}));
  expect_sound(nested, shells, 1e-6);
  EXPECT_EQ(nested.parts, 2);
  EXPECT_EQ(euler(nested.mesh), 4);
  EXPECT_EQ(nested.boundary_edges, 0);
}

TEST(MarchingTriangles, EdgesShortenWhereTheSurfaceBends) {
  MarchingOptions options = with(0.1, {Vec3(0, 0, 0.26)});
  options.min_edge_length = 0.015;
  options.max_normal_turn = 0.5;
  const MarchingResult result = marching_triangles(lens, options);
  expect_sound(result, lens, 1e-6);
  EXPECT_EQ(result.parts, 1);
  EXPECT_EQ(result.boundary_edges, 0);
  EXPECT_EQ(euler(result.mesh), 2);
  const auto [low, high] = std::minmax_element(result.sizes.begin(), result.sizes.end());
  EXPECT_LT(*low, 0.05);
  EXPECT_GT(*high, 0.09);
  EXPECT_GE(triangle_quality(result.mesh).mean_min_angle, 45.0);
}

TEST(MarchingTriangles, DomainLimitsTheSurface) {
  MarchingOptions options = with(0.1, {Vec3(0, 0, 1)});
  options.domain = [](const Vec3& p) { return p[2] > 0.2; };
  const MarchingResult result = marching_triangles(sphere, options);
  expect_sound(result, sphere, 1e-6);
  EXPECT_EQ(euler(result.mesh), 1);
  EXPECT_EQ(boundary_loops(result.mesh, connectivity(result.mesh)).size(), 1u);
  const double expected = 2.0 * M_PI * 0.8 / (std::sqrt(3.0) / 4.0 * 0.01);
  EXPECT_NEAR(result.mesh.triangle_count(), expected, 0.15 * expected);
}

TEST(MarchingTriangles, SameInputSameBytes) {
  const MarchingResult first = marching_triangles(torus, with(0.08, {Vec3(1.4, 0, 0)}));
  const MarchingResult second = marching_triangles(torus, with(0.08, {Vec3(1.4, 0, 0)}));
  ASSERT_EQ(first.mesh.triangles, second.mesh.triangles);
  ASSERT_EQ(first.mesh.vertices.size(), second.mesh.vertices.size());
  EXPECT_EQ(std::memcmp(first.mesh.vertices.data(), second.mesh.vertices.data(),
                        first.mesh.vertices.size() * sizeof(Vec3)),
            0);
}

TEST(MarchingTriangles, RefusesWhatCannotBeMeshed) {
  EXPECT_THROW(marching_triangles(sphere, with(0.1, {})), Error);
  EXPECT_THROW(marching_triangles(sphere, with(0.0, {Vec3(1, 0, 0)})), Error);
  EXPECT_THROW(marching_triangles(sphere, with(std::nan(""), {Vec3(1, 0, 0)})), Error);
  const ImplicitFunction nothing = [](const Vec3&, Vec3* g) {
    if (g) *g = Vec3(0, 0, 0);
    return 1.0;
  };
  EXPECT_THROW(marching_triangles(nothing, with(0.1, {Vec3(1, 0, 0)})), Error);
  const ImplicitFunction not_a_number = [](const Vec3&, Vec3* g) {
    if (g) *g = Vec3::Constant(std::nan(""));
    return std::nan("");
  };
  EXPECT_THROW(marching_triangles(not_a_number, with(0.1, {Vec3(1, 0, 0)})), Error);
  const ImplicitFunction plane = [](const Vec3& p, Vec3* g) {
    if (g) *g = Vec3(0, 0, 1);
    return p[2];
  };
  MarchingOptions endless = with(0.1, {Vec3(0, 0, 0)});
  endless.max_vertices = 2000;
  EXPECT_THROW(marching_triangles(plane, endless), Error);
}

}  // namespace
}  // namespace fascia::smas
