#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>

#include "builder/geodesics/path.h"
#include "geometry/error.h"
#include "tests/geodesics/surfaces.h"

namespace fascia::geodesics {
namespace {

double polyline_length(const Path& path) {
  double sum = 0.0;
  for (size_t i = 0; i + 1 < path.positions.size(); ++i)
    sum += (path.positions[i + 1] - path.positions[i]).norm();
  return sum;
}

/// Weights of `point` in triangle `triangle`, or NaN where it does not lie on it.
Vec3 weights_in(const TriangleMesh& mesh, const SurfacePoint& point, int triangle) {
  Vec3 weights = Vec3::Zero();
  for (int a = 0; a < 3; ++a) {
    bool shared = false;
    for (int b = 0; b < 3; ++b)
      if (mesh.triangles[point.triangle][a] == mesh.triangles[triangle][b]) {
        weights[b] = point.barycentric[a];
        shared = true;
      }
    if (!shared && point.barycentric[a] != 0.0) return Vec3::Constant(std::nan(""));
  }
  return weights;
}

void expect_sound(const Surface& surface, const Path& path) {
  ASSERT_GE(path.points.size(), 2u);
  ASSERT_EQ(path.points.size(), path.positions.size());
  EXPECT_TRUE(path.counters.converged);
  EXPECT_NEAR(polyline_length(path), path.length, 1e-9 * (1.0 + path.length));
  for (size_t i = 0; i + 1 < path.points.size(); ++i)
    EXPECT_NEAR(weights_in(surface.mesh, path.points[i], path.points[i + 1].triangle).sum(), 1.0, 1e-9)
        << "segment " << i << " does not lie in its triangle";
}

TEST(Connect, IsTheSegmentOnAPlane) {
  const Surface surface = make_surface(plane(17));
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0.01, 0.99);
  for (int i = 0; i < 100; ++i) {
    const SurfacePoint a = below(surface.mesh, unit(random), unit(random));
    const SurfacePoint b = below(surface.mesh, unit(random), unit(random));
    const Path path = connect(surface, a, b);
    expect_sound(surface, path);
    EXPECT_NEAR(path.length, (position(surface.mesh, a) - position(surface.mesh, b)).norm(), 1e-14);
    EXPECT_EQ(path.counters.straight_lengths, 1);
  }
}

TEST(Connect, RunsStraightOverTheVerticesOfAGrid) {
  const Surface surface = make_surface(plane(8));
  const Path path = connect(surface, at_vertex(surface.mesh, 0), at_vertex(surface.mesh, 80));
  expect_sound(surface, path);
  EXPECT_NEAR(path.length, std::sqrt(2.0), 1e-14);
}

TEST(Connect, JoinsOppositeCornersOfACube) {
  const Surface surface = make_surface(cube());
  for (const auto& [a, b] : {std::pair(0, 6), std::pair(1, 7), std::pair(2, 4), std::pair(3, 5)}) {
    const Path path = connect(surface, at_vertex(surface.mesh, a), at_vertex(surface.mesh, b));
    expect_sound(surface, path);
    EXPECT_NEAR(path.length, std::sqrt(5.0), 1e-12);
  }
}

TEST(Connect, LeavesTheCornerOfACubeToOneSide) {
  // Down the middle of two faces over a corner's neighbourhood: no geodesic runs through a corner.
  const Surface surface = make_surface(cube());
  const SurfacePoint a = at(2, 0.0, 0.0, 1.0), b = at(1, 1.0, 0.0, 0.0);
  const Path path = connect(surface, a, b);
  expect_sound(surface, path);
  EXPECT_EQ(path.counters.pinned_vertices, 0);
}

TEST(Connect, JoinsMiddlesOfOppositeEdgesOfATetrahedron) {
  const Surface surface = make_surface(tetrahedron());
  const double edge = std::sqrt(8.0);
  // Edges 0-1 and 2-3.
  const Path path = connect(surface, at(0, 0.5, 0.5, 0.0), at(2, 0.0, 0.5, 0.5));
  expect_sound(surface, path);
  EXPECT_NEAR(path.length, edge, 1e-12);
}

TEST(Connect, FollowsTheHelixOfAPrism) {
  const int around = 60;
  const double radius = 1.0, height = 2.0;
  const Surface surface = make_surface(cylinder(around, 31, radius, height));
  const double chord = 2 * radius * std::sin(kPi / around);
  for (int steps : {5, 12, 20}) {
    const Path path =
        connect(surface, at_vertex(surface.mesh, 3 * around), at_vertex(surface.mesh, 28 * around + steps));
    expect_sound(surface, path);
    EXPECT_NEAR(path.length, std::hypot(steps * chord, 25.0 / 31 * height), 1e-12);
    EXPECT_NEAR(path.length, std::hypot(steps * 2 * kPi / around, 25.0 / 31 * height), 2e-3);
  }
}

TEST(Connect, NearsTheArcOfASphereWithTheSquareOfTheEdge) {
  const Vec3 a = Vec3(0.3, 0.5, 0.81).normalized(), b = Vec3(-0.6, 0.4, 0.2).normalized();
  const double arc = std::acos(a.dot(b));
  double last = 0.0;
  for (int levels : {3, 4, 5}) {
    const Surface surface = make_surface(sphere(levels));
    int from = 0, to = 0;
    for (int v = 0; v < surface.mesh.vertex_count(); ++v) {
      if (surface.mesh.vertices[v].dot(a) > surface.mesh.vertices[from].dot(a)) from = v;
      if (surface.mesh.vertices[v].dot(b) > surface.mesh.vertices[to].dot(b)) to = v;
    }
    const double exact = std::acos(surface.mesh.vertices[from].dot(surface.mesh.vertices[to]));
    const Path path = connect(surface, at_vertex(surface.mesh, from), at_vertex(surface.mesh, to));
    expect_sound(surface, path);
    const double error = std::abs(path.length - exact) / arc;
    if (last > 0.0) {
      EXPECT_LT(error, last / 2.5);
    }
    last = error;
  }
  EXPECT_LT(last, 1e-3);
}

TEST(Connect, PassesThroughTheVertexOfASaddle) {
  const Surface surface = make_surface(saddle());
  EXPECT_NEAR(total_angle(surface, 0), 3 * kPi, 1e-12);
  // 4.5 triangles apart on both sides: 3π/2 each, so the geodesic must pass the vertex.
  const SurfacePoint a = at(0, 0.4, 0.6, 0.0);    // on spoke 1, at 0.6 of it
  const SurfacePoint b = at(4, 0.5, 0.25, 0.25);  // middle of triangle 4's wedge
  const Path path = connect(surface, a, b);
  expect_sound(surface, path);
  const double spoke = std::sqrt(2.0);
  EXPECT_NEAR(path.length, 0.6 * spoke + 0.5 * spoke * std::sqrt(3.0) / 2, 1e-12);
  EXPECT_EQ(path.counters.pinned_vertices, 1);
  EXPECT_NEAR(path.counters.unevenness, 0.0, 1e-9);
  // Three triangles apart on one side: a straight angle there, 2π on the other.
  const Path uneven = connect(surface, a, at(3, 0.5, 0.49, 0.01));
  expect_sound(surface, uneven);
  EXPECT_EQ(uneven.counters.pinned_vertices, 1);
  EXPECT_GT(uneven.counters.unevenness, 0.3);
}

TEST(Connect, TurnsBesideTheVertexOfACone) {
  // Five equilateral triangles: total angle 5π/3, the far side of the apex never pays.
  TriangleMesh cone;
  cone.vertices.push_back(Vec3(0, 0, 0));
  const double radius = 0.5 / std::sin(kPi / 5);
  for (int i = 0; i < 5; ++i)
    cone.vertices.push_back(Vec3(radius * std::cos(2 * kPi * i / 5), radius * std::sin(2 * kPi * i / 5),
                                 -std::sqrt(1 - radius * radius)));
  for (int i = 0; i < 5; ++i)
    cone.triangles.push_back({0, 1 + i, 1 + (i + 1) % 5});
  const Surface surface = make_surface(cone);
  const Path path = connect(surface, at(0, 0.2, 0.8, 0.0), at(2, 0.2, 0.4, 0.4));
  expect_sound(surface, path);
  EXPECT_EQ(path.counters.pinned_vertices, 0);
  // 2.5 triangles of 60° apart on both sides.
  const double b = 0.8 * std::sqrt(3.0) / 2;
  EXPECT_NEAR(path.length, std::sqrt(0.64 + b * b - 2 * 0.8 * b * std::cos(kPi * 2.5 / 3)), 1e-12);
}

TEST(Connect, IsTheSameBackwardsBitByBit) {
  const Surface surface = make_surface(
      grid(30, 30, [](double u, double v) { return Vec3(u, v, 0.15 * std::sin(9 * u) * std::cos(7 * v)); }));
  std::mt19937 random(5);
  std::uniform_real_distribution<double> unit(0.05, 0.95);
  for (int i = 0; i < 60; ++i) {
    const SurfacePoint a = below(surface.mesh, unit(random), unit(random));
    const SurfacePoint b = below(surface.mesh, unit(random), unit(random));
    const Path there = connect(surface, a, b), back = connect(surface, b, a);
    expect_sound(surface, there);
    expect_sound(surface, back);
    ASSERT_EQ(there.positions.size(), back.positions.size());
    EXPECT_EQ(there.length, back.length);
    for (size_t k = 0; k < there.positions.size(); ++k)
      EXPECT_EQ(there.positions[k], back.positions[back.positions.size() - 1 - k]);
  }
}

TEST(Connect, DoesNotDependOnWhereTheSurfaceStands) {
  const TriangleMesh mesh =
      grid(24, 24, [](double u, double v) { return Vec3(u, v, 0.2 * std::sin(6 * u) * std::sin(5 * v)); });
  TriangleMesh moved = mesh;
  const Mat3 turn = Eigen::AngleAxisd(1.1, Vec3(1, 2, -0.5).normalized()).toRotationMatrix();
  for (Vec3& p : moved.vertices)
    p = turn * p + Vec3(3, -1, 2);
  const Surface first = make_surface(mesh), second = make_surface(moved);
  const SurfacePoint a = below(mesh, 0.13, 0.2), b = below(mesh, 0.91, 0.77);
  EXPECT_NEAR(connect(first, a, b).length, connect(second, a, b).length, 1e-12);
}

TEST(Connect, IsLocallyShortest) {
  // No vertex it passes and no edge it crosses can be left with a gain: angles of at least π on both sides.
  const Surface surface = make_surface(
      grid(40, 40, [](double u, double v) { return Vec3(u, v, 0.2 * std::sin(11 * u) * std::cos(8 * v)); }));
  std::mt19937 random(11);
  std::uniform_real_distribution<double> unit(0.02, 0.98);
  int pinned = 0;
  for (int i = 0; i < 100; ++i) {
    const SurfacePoint a = below(surface.mesh, unit(random), unit(random));
    const SurfacePoint b = below(surface.mesh, unit(random), unit(random));
    PathOptions searched;
    searched.search_first = true;
    for (const PathOptions& options : {PathOptions(), searched}) {
      const Path path = connect(surface, a, b, options);
      expect_sound(surface, path);
      pinned += path.counters.pinned_vertices;
      // Every inner point that is on an edge: straight when its two triangles are unfolded.
      for (size_t k = 1; k + 1 < path.points.size(); ++k) {
        const SurfacePoint& point = path.points[k];
        if (point.barycentric.maxCoeff() > 1 - 1e-9) continue;
        int e = 0;
        while (point.barycentric[(e + 2) % 3] != 0.0)
          ++e;
        const int h = 3 * point.triangle + e;
        const Vec3 along =
            (surface.mesh.vertices[surface.target(h)] - surface.mesh.vertices[surface.origin(h)])
                .normalized();
        const double in = (path.positions[k] - path.positions[k - 1]).normalized().dot(along);
        const double out = (path.positions[k + 1] - path.positions[k]).normalized().dot(along);
        EXPECT_NEAR(in, out, 1e-6);
      }
    }
  }
  EXPECT_GT(pinned, 0) << "the surface should have saddle vertices to pass";
}

TEST(Connect, CutsOrSearchesWhereTheTraceStalls) {
  const Surface surface = make_surface(grid(60, 60, [](double u, double v) {
    // Steep bowls, in which the projected trace gets caught.
    const double x = std::sin(12 * u), y = std::sin(11 * v);
    return Vec3(u, v, 0.3 * x * x * y * y * y * y);
  }));
  std::mt19937 random(4);
  std::uniform_real_distribution<double> unit(0.05, 0.95);
  int cut = 0;
  for (int i = 0; i < 200; ++i) {
    const SurfacePoint a = below(surface.mesh, unit(random), unit(random));
    const SurfacePoint b = below(surface.mesh, unit(random), unit(random));
    const Path path = connect(surface, a, b);
    expect_sound(surface, path);
    PathOptions searched;
    searched.search_first = true;
    EXPECT_LE(path.length, connect(surface, a, b, searched).length * 1.25);
    cut += path.counters.cut || path.counters.searched;
  }
  EXPECT_GT(cut, 0);
}

TEST(Connect, GoesAroundAHole) {
  TriangleMesh mesh = plane(20);
  std::vector<Triangle> kept;
  for (const Triangle& t : mesh.triangles) {
    const Vec3 c = (mesh.vertices[t[0]] + mesh.vertices[t[1]] + mesh.vertices[t[2]]) / 3;
    if (std::abs(c[0] - 0.5) > 0.2 || std::abs(c[1] - 0.5) > 0.2) kept.push_back(t);
  }
  mesh.triangles = kept;
  const Surface surface = make_surface(mesh);
  const Path path = connect(surface, below(mesh, 0.1, 0.45), below(mesh, 0.9, 0.45));
  expect_sound(surface, path);
  EXPECT_TRUE(path.counters.searched);
  // Over the corners (0.3, 0.3) and (0.7, 0.3).
  EXPECT_NEAR(path.length, 2 * std::hypot(0.2, 0.15) + 0.4, 1e-12);
  EXPECT_EQ(path.counters.straight_lengths, 3);
}

TEST(Connect, EndsOnVerticesEdgesAndInTheSameTriangle) {
  const Surface surface = make_surface(plane(6));
  const Path none = connect(surface, at(5, 0.2, 0.3, 0.5), at(5, 0.2, 0.3, 0.5));
  EXPECT_EQ(none.length, 0.0);
  const Path edge = connect(surface, at(0, 0.5, 0.5, 0.0), at(30, 0.0, 0.5, 0.5));
  expect_sound(surface, edge);
  EXPECT_NEAR(edge.length, (edge.positions.front() - edge.positions.back()).norm(), 1e-14);
  // The same vertex named in two triangles.
  const int vertex = 8;
  std::vector<SurfacePoint> names;
  for (int t = 0; t < surface.mesh.triangle_count(); ++t)
    for (int e = 0; e < 3; ++e)
      if (surface.mesh.triangles[t][e] == vertex) {
        SurfacePoint p;
        p.triangle = t;
        p.barycentric[e] = 1.0;
        names.push_back(p);
      }
  for (const SurfacePoint& p : names)
    for (const SurfacePoint& q : names)
      EXPECT_EQ(connect(surface, p, q).length, 0.0);
}

TEST(Connect, TakesTrianglesWithoutArea) {
  TriangleMesh mesh = plane(10);
  for (int v : {48, 49, 60})
    mesh.vertices[v] = mesh.vertices[v + 1];  // zero edges
  mesh.vertices[82] = 0.5 * (mesh.vertices[81] + mesh.vertices[83]);
  const Surface surface = make_surface(mesh);
  EXPECT_GT(surface.mollification, 0.0);
  std::mt19937 random(9);
  std::uniform_int_distribution<int> triangle(0, mesh.triangle_count() - 1);
  for (int i = 0; i < 200; ++i) {
    const SurfacePoint a = at(triangle(random), 0.2, 0.3, 0.5), b = at(triangle(random), 0.6, 0.2, 0.2);
    const Path path = connect(surface, a, b);
    EXPECT_TRUE(path.counters.converged);
    EXPECT_TRUE(std::isfinite(path.length));
    for (const Vec3& p : path.positions)
      EXPECT_TRUE(p.allFinite());
    EXPECT_GE(path.length, (position(mesh, a) - position(mesh, b)).norm() - 1e-6);
    EXPECT_LE(path.length, 1.6);
  }
}

TEST(Connect, NamesPartsThatDoNotHangTogether) {
  TriangleMesh mesh = plane(3);
  const int first = mesh.triangle_count(), offset = mesh.vertex_count();
  for (const Vec3& p : plane(3).vertices)
    mesh.vertices.push_back(p + Vec3(5, 0, 0));
  for (const Triangle& t : plane(3).triangles)
    mesh.triangles.push_back({t[0] + offset, t[1] + offset, t[2] + offset});
  const Surface surface = make_surface(mesh);
  try {
    connect(surface, at(0, 0.3, 0.3, 0.4), at(first, 0.3, 0.3, 0.4));
    FAIL() << "unconnected ends accepted";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("no chain of triangles"), std::string::npos);
  }
  EXPECT_THROW(connect(surface, at(-1, 1, 0, 0), at(0, 1, 0, 0)), Error);
  EXPECT_THROW(connect(surface, at(0, std::nan(""), 0, 0), at(0, 1, 0, 0)), Error);
  EXPECT_THROW(connect(surface, at(0, -1, -1, -1), at(0, 1, 0, 0)), Error);
}

TEST(MakeSurface, RejectsInvalidMeshes) {
  EXPECT_THROW(make_surface({}), Error);
  TriangleMesh mesh = plane(2);
  mesh.vertices[3][1] = std::nan("");
  EXPECT_THROW(make_surface(mesh), Error);
  mesh = plane(2);
  mesh.triangles[1][2] = 99;
  EXPECT_THROW(make_surface(mesh), Error);
  mesh = plane(2);
  mesh.triangles[1][2] = mesh.triangles[1][0];
  EXPECT_THROW(make_surface(mesh), Error);
}

TEST(Resample, DividesThePathEvenly) {
  const Surface surface = make_surface(cylinder(40, 20, 1.0, 1.0));
  const Path path = connect(surface, at_vertex(surface.mesh, 0), at_vertex(surface.mesh, 20 * 40 + 9));
  const auto points = resample(surface, path, 11);
  ASSERT_EQ(points.size(), 11u);
  for (size_t i = 0; i + 1 < points.size(); ++i)
    EXPECT_NEAR(connect(surface, points[i], points[i + 1]).length, path.length / 10, 1e-9);
  EXPECT_LT((position(surface.mesh, points.front()) - path.positions.front()).norm(), 1e-12);
  EXPECT_LT((position(surface.mesh, points.back()) - path.positions.back()).norm(), 1e-12);
}

}  // namespace
}  // namespace fascia::geodesics
