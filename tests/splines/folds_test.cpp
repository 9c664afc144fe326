#include "builder/splines/folds.h"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "geometry/error.h"
#include "tests/splines/scatter.h"

namespace fascia::splines {
namespace {

/// A frame that stays and a landmark in its middle that goes too far.
struct Pushed {
  std::vector<Vec3> source, target;
  Bounds region;
  explicit Pushed(double by) {
    for (int i = 0; i < 8; ++i)
      source.emplace_back(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
    for (double side : {-0.4, 0.4})
      source.emplace_back(side, 0, 0);
    target = source;
    target[8].x() += by;
    region = {Vec3(-1, -1, -1), Vec3(1, 1, 1)};
  }
};

TEST(Folds, IdentityAndAffineMapsAreJudgedExactly) {
  const Bounds cube{Vec3(-1, -1, -1), Vec3(1, 1, 1)};
  EXPECT_EQ(check_folds(Warp(), cube).least_determinant, 1);
  const std::vector<Vec3> source = scattered(10, 1);
  std::vector<Vec3> target = source, mirrored = source;
  for (Vec3& p : target)
    p = p.cwiseProduct(Vec3(0.5, 2, 0.8));
  for (Vec3& p : mirrored)
    p.x() = -p.x();
  EXPECT_NEAR(check_folds(fit_warp(source, target), cube).least_determinant, 0.8, 1e-9);
  const FoldReport report = check_folds(fit_warp(source, mirrored), cube);
  EXPECT_NEAR(report.least_determinant, -1, 1e-9);
  EXPECT_EQ(report.folded, report.samples);
}

TEST(Folds, APushPastANeighbourIsFoundAndMendedBothWays) {
  const Pushed case_(0.95);
  const Warp plain = fit_warp(case_.source, case_.target);
  const FoldReport report = check_folds(plain, case_.region);
  EXPECT_FALSE(report.sound());
  EXPECT_LT(report.least_determinant, 0);
  EXPECT_NEAR(plain.jacobian(report.where).determinant(), report.least_determinant, 1e-12);

  const UnfoldedResult smooth = fit_unfolded(case_.source, case_.target, case_.region, FoldRemedy::smooth);
  EXPECT_TRUE(smooth.report.sound());
  EXPECT_GT(smooth.lambda, 0);
  EXPECT_GT(smooth.largest_miss, 0.01);
  // A fifth of the smoothing is not enough: lambda is near the least that is.
  WarpOptions weaker;
  weaker.lambda = smooth.lambda / 5;
  EXPECT_FALSE(check_folds(fit_warp(case_.source, case_.target, weaker), case_.region).sound());
}

TEST(Folds, ComposedStepsArriveExactlyWithoutFolds) {
  // Two landmarks that pass each other at a distance.
  Pushed case_(0);
  case_.source[8] = {-0.5, 0.2, 0};
  case_.source[9] = {0.5, -0.2, 0};
  case_.target = case_.source;
  case_.target[8].x() += 0.8;
  case_.target[9].x() -= 0.8;
  const Warp plain = fit_warp(case_.source, case_.target);
  ASSERT_FALSE(check_folds(plain, case_.region).sound());
  const UnfoldedResult walked = fit_unfolded(case_.source, case_.target, case_.region, FoldRemedy::compose);
  EXPECT_TRUE(walked.report.sound());
  EXPECT_GE(walked.map.steps().size(), 2u);
  EXPECT_LT(walked.largest_miss, 1e-9);
  for (const Vec3& p : scattered(300, 2))
    EXPECT_GT(walked.map.jacobian(p).determinant(), 0);
  // The Jacobian is the derivative of the whole walk.
  const Vec3 p(0.11, 0.23, -0.31);
  for (int axis = 0; axis < 3; ++axis) {
    const Vec3 h = 1e-6 * Vec3::Unit(axis);
    EXPECT_LT((walked.map.jacobian(p).col(axis) - (walked.map(p + h) - walked.map(p - h)) / 2e-6).norm(),
              1e-6);
  }
  const std::vector<Vec3> some = scattered(5, 3);
  for (size_t i = 0; i < some.size(); ++i)
    EXPECT_LT((walked.map(some)[i] - walked.map(some[i])).norm(), 1e-12);
}

TEST(Folds, SoundWarpsAreLeftAlone) {
  const Pushed case_(0.1);
  const UnfoldedResult result = fit_unfolded(case_.source, case_.target, case_.region, FoldRemedy::compose);
  EXPECT_EQ(result.map.steps().size(), 1u);
  EXPECT_LT(result.largest_miss, 1e-12);
}

TEST(Folds, RefusesMirroredLandmarksAndBadRegions) {
  const Pushed case_(0);
  std::vector<Vec3> mirrored = case_.source;
  for (Vec3& p : mirrored)
    p.y() = -p.y();
  for (FoldRemedy remedy : {FoldRemedy::compose, FoldRemedy::smooth})
    EXPECT_THROW(fit_unfolded(case_.source, mirrored, case_.region, remedy), Error);
  EXPECT_THROW(check_folds(Warp(), Bounds{}), Error);
  FoldOptions options;
  options.resolution = 1;
  EXPECT_THROW(check_folds(Warp(), case_.region, options), Error);
}

}  // namespace
}  // namespace fascia::splines
