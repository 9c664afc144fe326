#include "builder/geodesics/trace.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <random>

#include "geometry/error.h"
#include "tests/geodesics/surfaces.h"

namespace fascia::geodesics {
namespace {

TEST(Trace, IsALineOnAPlane) {
  const Surface surface = make_surface(plane(23));
  std::mt19937 random(2);
  std::uniform_real_distribution<double> angle(0.0, 2 * kPi);
  for (int i = 0; i < 200; ++i) {
    const SurfacePoint start = below(surface.mesh, 0.5 + 0.001 * i / 7, 0.51);
    const double a = angle(random);
    const Vec3 direction(std::cos(a), std::sin(a), 0.0);
    const TraceResult result = trace(surface, start, direction, 0.4);
    EXPECT_FALSE(result.reached_boundary);
    EXPECT_LT((result.path.positions.back() - position(surface.mesh, start) - 0.4 * direction).norm(), 1e-13);
  }
}

TEST(Trace, StartsFromVerticesAndEdgesInAnyDirection) {
  const Surface surface = make_surface(plane(10));
  for (const SurfacePoint& start :
       {at_vertex(surface.mesh, 60), at(110, 0.5, 0.5, 0.0), at(110, 0.0, 0.3, 0.7)})
    for (int i = 0; i < 48; ++i) {
      const Vec3 direction(std::cos(i * kPi / 24), std::sin(i * kPi / 24), 0.0);
      const TraceResult result = trace(surface, start, direction, 0.33);
      ASSERT_FALSE(result.reached_boundary) << i;
      EXPECT_LT((result.path.positions.back() - position(surface.mesh, start) - 0.33 * direction).norm(),
                1e-12)
          << i;
    }
}

TEST(Trace, ReturnsToItsStartAroundACylinder) {
  const int around = 48;
  const Surface surface = make_surface(cylinder(around, 9, 1.0, 1.0));
  const double girth = around * 2 * std::sin(kPi / around);
  const SurfacePoint start = at(2 * around * 4, 0.3, 0.3, 0.4);
  const Vec3 p = position(surface.mesh, start);
  const Vec3 direction = triangle_normal(surface.mesh, start.triangle).cross(Vec3::UnitZ());
  for (double sign : {-1.0, 1.0}) {
    const TraceResult result = trace(surface, start, sign * direction, girth);
    EXPECT_LT((result.path.positions.back() - p).norm(), 1e-11);
  }
}

TEST(Trace, HalvesTheAngleOfAVertex) {
  // On a saddle of 3π along spoke 1 through the vertex: out in the middle between spokes 5 and 6.
  const Surface surface = make_surface(saddle());
  const SurfacePoint start = at(0, 0.4, 0.6, 0.0);
  const TraceResult result = trace(surface, start, -surface.mesh.vertices[1], 1.2);
  ASSERT_FALSE(result.reached_boundary);
  EXPECT_EQ(result.vertices_passed, 1);
  const Vec3 wedge = (surface.mesh.vertices[5] + surface.mesh.vertices[6]).normalized();
  EXPECT_LT((result.path.positions.back() - (1.2 - 0.6 * std::sqrt(2.0)) * wedge).norm(), 1e-12);
}

TEST(Trace, AgreesWithTheBoundaryValuePath) {
  const Surface surface = make_surface(
      grid(30, 30, [](double u, double v) { return Vec3(u, v, 0.05 * std::sin(5 * u) * std::cos(4 * v)); }));
  int agreeing = 0;
  std::mt19937 random(8);
  std::uniform_real_distribution<double> angle(0.0, 2 * kPi);
  for (int i = 0; i < 50; ++i) {
    const SurfacePoint start = below(surface.mesh, 0.503, 0.481);
    const double a = angle(random);
    const TraceResult result = trace(surface, start, Vec3(std::cos(a), std::sin(a), 0.0), 0.35);
    ASSERT_FALSE(result.reached_boundary);
    const Path path = connect(surface, start, result.path.points.back());
    // Beside a vertex of positive curvature two geodesics are shortest, each on its side.
    EXPECT_NEAR(path.length, 0.35, 1e-6);
    agreeing += std::abs(path.length - 0.35) < 1e-12;
  }
  EXPECT_GE(agreeing, 45);
}

TEST(Trace, StopsAtTheBoundary) {
  const Surface surface = make_surface(plane(7));
  const TraceResult result = trace(surface, below(surface.mesh, 0.52, 0.47), Vec3(1, 0, 0), 3.0);
  EXPECT_TRUE(result.reached_boundary);
  EXPECT_NEAR(result.path.length, 0.48, 1e-12);
  EXPECT_NEAR(result.path.positions.back()[0], 1.0, 1e-12);
}

TEST(Trace, RejectsInvalidDirectionsAndLengths) {
  const Surface surface = make_surface(plane(3));
  EXPECT_THROW(trace(surface, at(0, 0.3, 0.3, 0.4), Vec3(0, 0, 1), 1.0), Error);
  EXPECT_THROW(trace(surface, at(0, 0.3, 0.3, 0.4), Vec3(0, 0, 0), 1.0), Error);
  EXPECT_THROW(trace(surface, at(0, 0.3, 0.3, 0.4), Vec3(1, 0, 0), -1.0), Error);
  EXPECT_THROW(trace(surface, at(0, 0.3, 0.3, 0.4), Vec3(1, 0, 0), std::nan("")), Error);
}

}  // namespace
}  // namespace fascia::geodesics
