#include "builder/splines/warp.h"

#include <gtest/gtest.h>

#include "geometry/error.h"
#include "tests/splines/scatter.h"

namespace fascia::splines {
namespace {

TEST(Warp, AffineMapsAreExact) {
  Mat3 A;
  A << 1.2, 0.1, -0.3, 0.2, 0.8, 0.1, 0, -0.1, 1.1;
  const Vec3 b(0.5, -2, 1);
  const std::vector<Vec3> source = scattered(30, 15);
  std::vector<Vec3> target;
  for (const Vec3& p : source)
    target.push_back(A * p + b);
  const Warp warp = fit_warp(source, target);
  const std::vector<Vec3> probes = scattered(20, 16);
  const std::vector<Vec3> carried = warp(probes);
  for (size_t i = 0; i < probes.size(); ++i) {
    EXPECT_LT((carried[i] - (A * probes[i] + b)).norm(), 1e-11);
    EXPECT_LT((warp(probes[i]) - carried[i]).norm(), 1e-12);
    EXPECT_LT((warp.jacobian(probes[i]) - A).norm(), 1e-10);
  }
}

TEST(Warp, LandmarksArriveAndTheJacobianIsItsDerivative) {
  const std::vector<Vec3> source = scattered(60, 17);
  std::vector<Vec3> target = source;
  for (Vec3& p : target)
    p += 0.2 * Vec3(p.y() * p.z(), p.x() * p.x(), p.x());
  for (double exponent : {1.0, 3.0}) {
    WarpOptions options;
    options.exponent = exponent;
    const Warp warp = fit_warp(source, target, options);
    for (size_t i = 0; i < source.size(); ++i)
      EXPECT_LT((warp(source[i]) - target[i]).norm(), 1e-10);
    for (const Vec3& p : scattered(5, 18)) {
      const Mat3 jacobian = warp.jacobian(p);
      for (int axis = 0; axis < 3; ++axis) {
        const Vec3 h = 1e-6 * Vec3::Unit(axis);
        EXPECT_LT((jacobian.col(axis) - (warp(p + h) - warp(p - h)) / 2e-6).norm(), 1e-6);
      }
    }
  }
  EXPECT_THROW(fit_warp(source, std::vector<Vec3>(3)), Error);
  EXPECT_EQ(Warp()(Vec3(1, 2, 3)), Vec3(1, 2, 3));
}

TEST(Warp, FlatLandmarksLeaveTheNormalDirectionAlone) {
  const std::vector<Vec3> source = scattered(10, 19, true);
  std::vector<Vec3> target = source;
  for (Vec3& p : target)
    p *= 2;
  const Warp warp = fit_warp(source, target);
  EXPECT_LT((warp(Vec3(0.1, 0.2, 0.7)) - Vec3(0.2, 0.4, 0.7)).norm(), 1e-9);
}

}  // namespace
}  // namespace fascia::splines
