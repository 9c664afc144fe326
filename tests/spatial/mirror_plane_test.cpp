#include "builder/spatial/mirror_plane.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>

#include "tests/shapes/grid.h"

namespace fascia::spatial {
namespace {

/// A vault of 160 by 120 mm with a ridge along x = 0, as a face has with its nose, cut into triangles that
/// are not alike on both sides; `scar` metres high 40 mm to the left.
TriangleMesh face_like(double scar = 0.0) {
  return testing::waving_vault(83, 61, 3e-4, [&](double x, double y) {
    return 0.02 * std::exp(-x * x / 1e-4 - y * y / 9e-4) +
           scar * std::exp(-((x - 0.04) * (x - 0.04) + y * y) / 6e-5);
  });
}

std::vector<Vec3> some_of(const TriangleMesh& mesh) {
  std::vector<Vec3> places;
  for (size_t v = 0; v < mesh.vertices.size(); v += 11)
    places.push_back(mesh.vertices[v]);
  return places;
}

/// As landmarks found with some millimetres' error leave it.
MirrorPlane beside() {
  MirrorPlane plane;
  plane.point = Vec3(0.0035, 0.01, 0.02);
  plane.normal =
      (Eigen::AngleAxisd(0.06, Vec3::UnitY()) * Eigen::AngleAxisd(0.04, Vec3::UnitZ())) * Vec3::UnitX();
  return plane;
}

void expect_middle(const MirrorPlane& plane, double metres) {
  EXPECT_NEAR(plane.normal.norm(), 1.0, 1e-12);
  for (const Vec3& p : {Vec3(0, -0.06, 0.03), Vec3(0, 0.06, 0.03), Vec3(0, 0, 0.07)})
    EXPECT_LT(std::abs(plane.distance(p)), metres);
}

TEST(MirrorPlane, IsFoundFromFourMillimetresBeside) {
  const TriangleMesh mesh = face_like();
  const MirrorFit fit = fit_mirror_plane(SurfaceQuery(mesh), some_of(mesh), beside(), 0.01);
  expect_middle(fit.plane, 5e-5);
  EXPECT_LT(fit.most_apart(), 1e-4);
  EXPECT_GT(fit.apart.size(), 9 * some_of(mesh).size() / 10);
}

TEST(MirrorPlane, IsRobustAgainstAScarOnOneSide) {
  const TriangleMesh mesh = face_like(0.004);
  const MirrorFit fit = fit_mirror_plane(SurfaceQuery(mesh), some_of(mesh), beside(), 0.01);
  expect_middle(fit.plane, 1e-4);
}

TEST(MirrorPlane, FollowsTheSurfaceWhereverItStands) {
  TriangleMesh mesh = face_like();
  const Mat3 turn = Eigen::AngleAxisd(0.7, Vec3(1, 2, 3).normalized()).toRotationMatrix();
  const Vec3 shift(0.3, -1.2, 0.5);
  for (Vec3& p : mesh.vertices)
    p = turn * p + shift;
  MirrorPlane start = beside();
  start.point = turn * start.point + shift;
  start.normal = turn * start.normal;
  MirrorPlane plane = fit_mirror_plane(SurfaceQuery(mesh), some_of(mesh), start, 0.01).plane;
  plane.point = turn.transpose() * (plane.point - shift);
  plane.normal = turn.transpose() * plane.normal;
  expect_middle(plane, 5e-5);
}

TEST(MirrorPlane, IsUnchangedWithoutPointsWithinReach) {
  const TriangleMesh mesh = face_like();
  MirrorPlane far;
  far.point.x() = 1.0;
  const MirrorFit fit = fit_mirror_plane(SurfaceQuery(mesh), some_of(mesh), far, 0.01);
  EXPECT_EQ(fit.plane.point.x(), 1.0);
  EXPECT_TRUE(fit.apart.empty());
  EXPECT_TRUE(std::isinf(fit.most_apart()));
}

}  // namespace
}  // namespace fascia::spatial
