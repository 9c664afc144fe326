#include "geometry/alignment.h"

#include <gtest/gtest.h>

#include <cmath>

namespace fascia {
namespace {

const Vec3 corners[] = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 3}, {1, 1, 1}};

Mat4 map_of(double scale, const Mat3& rotation, const Vec3& shift) {
  Mat4 map = Mat4::Identity();
  map.topLeftCorner<3, 3>() = scale * rotation;
  map.topRightCorner<3, 1>() = shift;
  return map;
}

std::vector<Vec3> carried(const Mat4& map) {
  std::vector<Vec3> to;
  for (const Vec3& p : corners)
    to.push_back(transform_point(map, p));
  return to;
}

const Mat3 some_turn = Eigen::AngleAxisd(2.0, Vec3(1, -2, 0.5).normalized()).toRotationMatrix();

TEST(Alignment, ASimilarityIsFoundAgain) {
  const Mat4 map = map_of(0.4, some_turn, {1, 2, 3});
  EXPECT_LT((similarity(corners, carried(map)) - map).norm(), 1e-12);
}

TEST(Alignment, ARigidMotionKeepsLengthsEvenOfAScaledCopy) {
  const Mat4 found = rigid_motion(corners, carried(map_of(0.4, some_turn, {1, 2, 3})));
  EXPECT_LT((found.topLeftCorner<3, 3>() - some_turn).norm(), 1e-12);
}

TEST(Alignment, ReflectionsAreExcluded) {
  Mat3 mirror = Mat3::Identity();
  mirror(0, 0) = -1.0;
  EXPECT_NEAR(nearest_rotation(mirror).determinant(), 1.0, 1e-12);
  const Mat4 found = similarity(corners, carried(map_of(1, mirror, Vec3::Zero())));
  EXPECT_GT((found.topLeftCorner<3, 3>().determinant()), 0.0);
}

TEST(Alignment, TheNearestRotationOfAScaledRotationIsTheRotation) {
  EXPECT_LT((nearest_rotation(3.0 * some_turn) - some_turn).norm(), 1e-12);
}

TEST(Alignment, TheLeastRotationTurnsOntoByTheAngleBetween) {
  const Vec3 from(1, 2, 3), to(-2, 0.5, 1);
  const Eigen::Quaterniond turn = least_rotation(from, to);
  EXPECT_LT((turn * from.normalized() - to.normalized()).norm(), 1e-12);
  EXPECT_NEAR(Eigen::AngleAxisd(turn).angle(), std::acos(from.normalized().dot(to.normalized())), 1e-12);
  EXPECT_LT((least_rotation(from, Vec3(-from)) * from + from).norm(), 1e-7);
}

TEST(Alignment, PrincipalAxesOfABoxAreItsOwn) {
  std::vector<Vec3> box;
  for (double x : {-3.0, 3.0})
    for (double y : {-1.0, 1.0})
      for (double z : {-2.0, 2.0})
        box.push_back(some_turn * Vec3(x, y, z) + Vec3(5, 5, 5));
  const PrincipalAxes found = principal_axes(scatter(box));
  EXPECT_LT((found.values - Vec3(8, 32, 72)).norm(), 1e-11);
  EXPECT_NEAR(std::abs(found.axes.col(2).dot(some_turn.col(0))), 1.0, 1e-12);
  EXPECT_NEAR(std::abs(found.axes.col(0).dot(some_turn.col(1))), 1.0, 1e-12);
}

TEST(Alignment, ASphereIsFoundFromACapFarFromTheOrigin) {
  std::vector<Vec3> cap;
  const Vec3 centre(100, -50, 20);
  for (int i = 0; i < 200; ++i) {
    const double up = 0.5 + 0.5 * i / 199.0, around = 2.4 * i, ring = std::sqrt(1 - up * up);
    cap.push_back(centre + 0.012 * Vec3(ring * std::cos(around), ring * std::sin(around), up));
  }
  const Sphere found = least_squares_sphere(cap);
  EXPECT_LT((found.centre - centre).norm(), 1e-9);
  EXPECT_NEAR(found.radius, 0.012, 1e-9);
  EXPECT_LT(distance_rms(found, cap), 1e-9);
  EXPECT_EQ(least_squares_sphere(std::vector<Vec3>(3, centre)).radius, 0.0);
}

}  // namespace
}  // namespace fascia
