#include "builder/muscles/hull.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>

#include <cmath>

#include "builder/muscles/tangents.h"
#include "geometry/error.h"
#include "tests/geodesics/surfaces.h"

namespace fascia::muscles {
namespace {

using geodesics::kPi;
constexpr double kHalfPi = 0.5 * kPi;

/// A surface with its queries; must outlive the carrier.
struct Bench {
  explicit Bench(const TriangleMesh& mesh) : surface(geodesics::make_surface(mesh)), query(mesh) {}
  geodesics::Surface surface;
  spatial::SurfaceQuery query;
  Carrier carrier{surface, query, {}, {}};

  Hull hull(const std::vector<Vec3>& points) {
    std::vector<SurfacePoint> places;
    for (const Vec3& p : points)
      places.push_back(carrier.closest(p));
    return geodesic_hull(carrier, places, "test region");
  }
};

std::vector<Vec3> circle(double x, double y, double radius, int count) {
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i)
    points.emplace_back(x + radius * std::cos(2 * kPi * i / count),
                        y + radius * std::sin(2 * kPi * i / count), 0.0);
  return points;
}

bool has_corner(const Hull& hull, const Vec3& point) {
  for (const Vec3& p : hull.positions)
    if ((p - point).norm() < 1e-12) return true;
  return false;
}

TEST(GeodesicHull, IsTheConvexHullOnAPlane) {
  Bench bench(geodesics::plane(13));
  const std::vector<Vec3> shape = {Vec3(.2, .2, 0), Vec3(.8, .2, 0), Vec3(.8, .4, 0),
                                   Vec3(.4, .4, 0), Vec3(.4, .8, 0), Vec3(.2, .8, 0)};
  const Hull hull = bench.hull(shape);
  ASSERT_EQ(hull.size(), 5);
  EXPECT_FALSE(has_corner(hull, shape[3]));
  for (int i : {0, 1, 2, 4, 5})
    EXPECT_TRUE(has_corner(hull, shape[i]));
  EXPECT_NEAR(hull.turning, 2 * kPi, 1e-9);
  double girth = 0.0;
  for (double side : hull.sides)
    girth += side;
  EXPECT_NEAR(girth, .6 + .2 + std::sqrt(.32) + .2 + .6, 1e-12);
}

TEST(GeodesicHull, KeepsATriangleOnTheSphere) {
  Bench bench(geodesics::sphere(5));
  // Points that lie outside the chords but inside the great circles between the corners.
  const Vec3 a = Vec3(1, .2, .2).normalized(), b = Vec3(.2, 1, .2).normalized(),
             c = Vec3(.2, .2, 1).normalized();
  const Vec3 inner = ((a + b).normalized() + 0.02 * c).normalized();
  const Hull hull = bench.hull({a, b, c, inner, (a + b + c).normalized()});
  EXPECT_EQ(hull.size(), 3);
  // Gauss–Bonnet: the turning falls short of 2π by the curvature enclosed, that of the spherical triangle
  // but for the vertices along its sides, 0.003 each.
  const double area = 2 * std::atan(std::abs(a.cross(b).dot(c)) / (1 + a.dot(b) + b.dot(c) + c.dot(a)));
  EXPECT_NEAR(2 * kPi - hull.turning, area, 0.08);
}

TEST(GeodesicHull, ShrinksRegionsThatCoverHalfASphere) {
  Bench bench(geodesics::sphere(3));
  std::vector<Vec3> belt;
  for (const Vec3& p : circle(0, 0, 1, 12))
    belt.push_back((p - Vec3(0, 0, 0.001)).normalized());
  belt.push_back(Vec3(0, 0, 1));
  const Hull hull = bench.hull(belt);
  EXPECT_LT(hull.kept, 1.0);
  EXPECT_GT(hull.kept, 0.6);
  EXPECT_GE(hull.size(), 8);
  EXPECT_GT(hull.turning, 0.3);
  for (const Vec3& p : hull.positions)  // within the cap it was drawn from, at one distance from its middle
    EXPECT_NEAR(std::acos(p.normalized().z()), hull.kept * kHalfPi, 0.03);
}

TEST(GeodesicHull, ASliverTurnsOnceWhicheverWayItIsTurned) {
  Bench bench(geodesics::plane(13));
  for (const double off : {0.0, 1e-13, -1e-13, 1e-9, -1e-9})
    for (int turned = 0; turned < 16; ++turned) {
      const Eigen::AngleAxisd turn(0.2 * turned, Vec3::UnitZ());
      std::vector<Vec3> points;
      for (const Vec3& p : {Vec3(-.4, 0, 0), Vec3(.1, off, 0), Vec3(.4, 0, 0), Vec3(-.1, -off, 0)})
        points.push_back(Vec3(.5, .5, 0) + turn * p);
      const Hull hull = bench.hull(points);
      EXPECT_DOUBLE_EQ(hull.kept, 1.0);
      EXPECT_NEAR(hull.turning, 2 * kPi, 1e-3) << off << " " << turned;
    }
}

TEST(MutualTangent, HasTheLengthsOfTwoCircles) {
  Bench bench(geodesics::grid(30, 30, [](double u, double v) { return Vec3(4 * u - 1, 4 * v - 2, 0); }));
  const double r1 = 0.5, r2 = 0.25, distance = 1.8;
  const Hull a = bench.hull(circle(0, 0, r1, 240)), b = bench.hull(circle(distance, 0.0, r2, 240));
  const double outer = std::sqrt(distance * distance - (r1 - r2) * (r1 - r2));
  const double inner = std::sqrt(distance * distance - (r1 + r2) * (r1 + r2));
  for (const auto& [first, second, length] :
       {std::tuple(HullSide::right, HullSide::right, outer),
        std::tuple(HullSide::left, HullSide::left, outer), std::tuple(HullSide::right, HullSide::left, inner),
        std::tuple(HullSide::left, HullSide::right, inner)}) {
    const auto tangent = mutual_tangent(bench.carrier, a, b, first, second);
    ASSERT_TRUE(tangent.has_value());
    EXPECT_NEAR(tangent->length, length, 0.02);
  }
  // The outer ones leave on the sides they are asked for.
  const auto left = mutual_tangent(bench.carrier, a, b, HullSide::right, HullSide::right);
  EXPECT_GT(a.positions[left->a][1], 0.49);
  EXPECT_GT(b.positions[left->b][1], 0.24);
}

TEST(MutualTangent, KnowsOverlapAndContainment) {
  Bench bench(geodesics::grid(20, 20, [](double u, double v) { return Vec3(4 * u - 2, 4 * v - 2, 0); }));
  const Hull large = bench.hull(circle(0, 0, 1.0, 40)), inside = bench.hull(circle(0.1, 0.0, 0.3, 20)),
             beside = bench.hull(circle(1.2, 0.0, 0.5, 20));
  EXPECT_FALSE(mutual_tangent(bench.carrier, large, inside, HullSide::right, HullSide::right));
  EXPECT_TRUE(mutual_tangent(bench.carrier, large, beside, HullSide::right, HullSide::right));
  EXPECT_FALSE(mutual_tangent(bench.carrier, large, beside, HullSide::right, HullSide::left));
}

TEST(FacingArcs, FaceEachOtherInTheSameDirection) {
  Bench bench(geodesics::grid(30, 30, [](double u, double v) { return Vec3(4 * u - 1, 4 * v - 2, 0); }));
  const Hull a = bench.hull(circle(0, 0, 0.5, 48)), b = bench.hull(circle(1.8, 0, 0.5, 48));
  const auto left = mutual_tangent(bench.carrier, a, b, HullSide::right, HullSide::right);
  const auto right = mutual_tangent(bench.carrier, a, b, HullSide::left, HullSide::left);
  const FacingArcs arcs = facing_arcs(a, b, *left, *right);
  EXPECT_NEAR((along_arc(a, arcs.first_near, 0.5) - Vec3(0.5, 0, 0)).norm(), 0.0, 0.01);
  EXPECT_NEAR((along_arc(a, arcs.first_far, 0.5) - Vec3(-0.5, 0, 0)).norm(), 0.0, 0.01);
  EXPECT_NEAR((along_arc(b, arcs.second_near, 0.5) - Vec3(1.3, 0, 0)).norm(), 0.0, 0.01);
  EXPECT_LT(along_arc(b, arcs.second_near, 0.1)[1], along_arc(b, arcs.second_near, 0.9)[1]);
  EXPECT_LT(along_arc(a, arcs.first_near, 0.1)[1], along_arc(a, arcs.first_near, 0.9)[1]);
}

}  // namespace
}  // namespace fascia::muscles
