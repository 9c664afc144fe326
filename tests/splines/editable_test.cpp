#include "builder/splines/editable.h"

#include <gtest/gtest.h>

#include "geometry/error.h"
#include "tests/splines/scatter.h"

namespace fascia::splines {
namespace {

void expect_same(const EditableFactorisation& edited, const SplineOptions& options, const char* what) {
  const Eigen::MatrixXd data = Eigen::MatrixXd::Random(edited.sites().rows(), 3);
  const Spline a = edited.solve(data), b = fit(edited.sites(), data, options);
  for (const Vec3& p : scattered(10, 99))
    EXPECT_LT((a.value(p) - b.value(p)).norm(), 1e-8 * (1 + b.value(p).norm())) << what;
  EXPECT_NEAR(a.coefficients().energy / b.coefficients().energy, 1, 1e-8) << what;
}

TEST(Editable, EveryEditEqualsAFitFromScratch) {
  for (double exponent : {1.0, 3.0})
    for (double lambda : {0.0, 0.01}) {
      SplineOptions options;
      options.exponent = exponent;
      options.lambda = lambda;
      Sites sites;
      sites.points = scattered(50, 1);
      if (exponent > 2) sites.add_gradient(Vec3(0.1, 0, 0.2));
      EditableFactorisation edited(sites, options);
      expect_same(edited, options, "untouched");
      edited.add_value(Vec3(0.3, 1.2, -0.4), 2);
      expect_same(edited, options, "added");
      edited.move_value(7, Vec3(-1.5, 0.2, 0.1));
      EXPECT_EQ(edited.sites().points[7], Vec3(-1.5, 0.2, 0.1));
      expect_same(edited, options, "moved");
      edited.remove_value(3);
      expect_same(edited, options, "removed");
      edited.move_value(6, Vec3(-1.4, 0.2, 0.1));
      expect_same(edited, options, "moved twice");
      edited.remove_value(49);
      expect_same(edited, options, "the added one removed");
      EXPECT_GT(edited.border(), 0);
      if (exponent > 2) {
        edited.add_derivative(Vec3(0.5, 0.5, 0.5), Vec3(1, 2, 0));
        edited.remove_derivative(1);
        expect_same(edited, options, "derivatives");
      }
    }
}

TEST(Editable, ALongSessionOfEditsFactorsAnewInTime) {
  SplineOptions options;
  Sites sites;
  sites.points = scattered(30, 2);
  EditableFactorisation edited(sites, options, 8);
  const std::vector<Vec3> path = scattered(60, 3);
  int least = 100;
  for (int i = 0; i < 60; ++i) {
    edited.move_value(i % 30, path[i]);
    EXPECT_LE(edited.border(), 8);
    least = std::min(least, edited.border());
  }
  EXPECT_EQ(least, 0);
  expect_same(edited, options, "after 60 moves");
}

TEST(Editable, FromALineIntoThePlaneAndBack) {
  SplineOptions options;
  Sites sites;
  for (int i = 0; i < 6; ++i)
    sites.points.emplace_back(i, 0, 0);
  EditableFactorisation edited(sites, options);
  edited.add_value(Vec3(1, 2, 0));
  edited.add_value(Vec3(1, 0, 3));
  expect_same(edited, options, "grown");
  edited.remove_value(6);
  edited.remove_value(6);
  expect_same(edited, options, "shrunk");
}

TEST(Editable, RefusesBadEditsAndStaysUsable) {
  SplineOptions options;
  Sites sites;
  sites.points = scattered(12, 4);
  EditableFactorisation edited(sites, options);
  EXPECT_THROW(edited.add_value(sites.points[5]), Error);
  EXPECT_THROW(edited.move_value(2, sites.points[5]), Error);
  EXPECT_THROW(edited.move_value(12, Vec3(1, 1, 1)), Error);
  EXPECT_THROW(edited.remove_value(-1), Error);
  EXPECT_THROW(edited.add_value(Vec3(std::nan(""), 0, 0)), Error);
  EXPECT_THROW(edited.add_derivative(Vec3(0, 0, 0), Vec3(1, 0, 0)), Error) << "exponent 1";
  EXPECT_EQ(edited.sites().rows(), 12);
  expect_same(edited, options, "after refusals");
}

}  // namespace
}  // namespace fascia::splines
