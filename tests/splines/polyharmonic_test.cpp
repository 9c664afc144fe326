// Figures of the thesis' chapter 4 in closed form or to the digits of an independent computation
// (double precision, dense saddle system, NumPy).
#include "builder/splines/polyharmonic.h"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>

#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include "geometry/error.h"

namespace fascia::splines {
namespace {

constexpr double digits10 = 6e-11;

std::vector<Vec3> square_rim() {
  return {{0.5, 0.5, 0}, {9.5, 0.5, 0}, {0.5, 9.5, 0}, {9.5, 9.5, 0},
          {5, 0.5, 0},   {5, 9.5, 0},   {0.5, 5, 0},   {9.5, 5, 0}};
}

SplineOptions plane(double exponent, int degree = -1) {
  SplineOptions options;
  options.dimension = 2;
  options.exponent = exponent;
  options.degree = degree;
  return options;
}

std::vector<Vec3> random_points(int count, unsigned seed, bool flat = false) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<Vec3> out;
  for (int i = 0; i < count; ++i) {
    Vec3 p(uniform(random), uniform(random), uniform(random));
    if (flat) p.z() = 0;
    out.push_back(p);
  }
  return out;
}

TEST(ThinPlate, Figure42HasItsClosedForm) {
  Sites sites;
  sites.points = square_rim();
  Eigen::MatrixXd data(8, 1);
  data << 0, 0, 0, 0, 1.5, 1.5, -1.5, -1.5;
  const Factorisation factorisation(sites, plane(2));
  const Spline f = factorisation.solve(data);
  EXPECT_NEAR(f.scalar({5, 2.75, 0}), 0.4978166310, digits10);
  EXPECT_NEAR(f.scalar({2.75, 5, 0}), -0.4978166310, digits10);
  EXPECT_NEAR(f.scalar({2.75, 2.75, 0}), 0, 1e-12);
  EXPECT_NEAR(f.scalar({7, 3, 0}), 0, 1e-12);
  EXPECT_NEAR(f.scalar({0, 5, 0}), -1.6299048777, digits10);
  EXPECT_NEAR(f.scalar({5, 0, 0}), 1.6299048777, digits10);
  EXPECT_NEAR(f.scalar({3, 1, 0}), 0.8233989729, digits10);
  const Eigen::MatrixXd coefficients = factorisation.coefficients(data);
  const double amplitude = 1 / (27 * std::numbers::ln2);
  for (int i = 0; i < 4; ++i) {
    EXPECT_NEAR(coefficients(i, 0), 0, 1e-13);
    EXPECT_NEAR(coefficients(4 + i, 0), i < 2 ? amplitude : -amplitude, 1e-13);
  }
  EXPECT_NEAR(coefficients.bottomRows(3).norm(), 0, 1e-12);
  EXPECT_NEAR(f.seminorm_squared(), 48 * std::numbers::pi / (27 * std::numbers::ln2), 1e-9);
}

struct DirectionalCase {
  double exponent, cross, along, side, at_7_3;
};

TEST(ThinPlate, Figures43And44DirectionalDerivatives) {
  const double h = std::numbers::sqrt2 / 2;
  for (const DirectionalCase& expected :
       {DirectionalCase{3, 0, 0.8762316771, -0.1301628361, 0},
        DirectionalCase{3, 0.25, 0.8762316771, -0.2755190350, -0.2190579193},
        DirectionalCase{4, 0, 1.4573625250, -0.5008633160, 0},
        DirectionalCase{4, 0.25, 1.4573625250, -0.7198291451, -0.3643406312}}) {
    Sites sites;
    sites.points = square_rim();
    sites.derivative_points = {{5, 5, 0}, {5, 5, 0}};
    sites.derivative_directions = {{h, h, 0}, {-h, h, 0}};
    Eigen::MatrixXd data = Eigen::MatrixXd::Zero(10, 1);
    data.topRows(8) << 0, 0, 0, 0, 1.5, 1.5, -1.5, -1.5;
    data(8) = 1;
    data(9) = expected.cross;
    const Spline f = fit(sites, data, plane(expected.exponent));
    EXPECT_NEAR(f.scalar({7, 7, 0}), expected.along, digits10);
    EXPECT_NEAR(f.scalar({3, 3, 0}), -expected.along, digits10);
    EXPECT_NEAR(f.scalar({5, 2.75, 0}), expected.side, digits10);
    EXPECT_NEAR(f.scalar({7, 3, 0}), expected.at_7_3, digits10);
    Vec3 gradient;
    f.value_and_gradient({5, 5, 0}, gradient);
    Vec3 fast;
    EXPECT_NEAR(f.fast_value_and_gradient({5, 5, 0}, fast), f.value({5, 5, 0})[0], 1e-12);
    EXPECT_LT((fast - gradient).norm(), 1e-12);
    EXPECT_NEAR(gradient.dot(Vec3(h, h, 0)), 1, 1e-9);
    EXPECT_NEAR(gradient.dot(Vec3(-h, h, 0)), expected.cross, 1e-9);
  }
}

TEST(ThinPlate, Figure412bPoleOfAnOctahedronPressedIn) {
  Sites sites;
  sites.points = {{0, 0, 1}, {0, 0, -1}, {1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}};
  Eigen::MatrixXd data = Eigen::MatrixXd::Zero(6, 1);
  data(0) = -0.5;
  const Factorisation plate(sites, {});
  const Eigen::MatrixXd coefficients = plate.coefficients(data);
  const double w = 0.25 / (3 * (std::numbers::sqrt2 - 1));
  EXPECT_NEAR(w, 0.2011844635, digits10);
  // The kernel here is -r: the opposite sign of the closed form's.
  for (int i = 0; i < 6; ++i)
    EXPECT_NEAR(coefficients(i, 0), i < 2 ? -w : w / 2, 1e-13);
  const Spline f = plate.solve(data);
  const double h = std::numbers::sqrt2 / 2;
  EXPECT_NEAR(f.scalar({0, 0, 0}), -1.0 / 12, 1e-13);
  EXPECT_NEAR(f.coefficients().polynomial(3, 0) * f.coefficients().scale, -0.25, 1e-13);
  EXPECT_NEAR(f.scalar({h, 0, h}), -0.2817676563, digits10);
  EXPECT_NEAR(f.scalar({0, 0, 0.5}), -0.2558265427, digits10);
  EXPECT_NEAR(f.scalar({0, 0, 2}), -0.6783197522, digits10);
  EXPECT_NEAR(f.seminorm_squared(), 4 * std::numbers::pi * w, 1e-12);
  EXPECT_NEAR(f.seminorm_squared(), 2.5281585306, digits10);

  SplineOptions cubic;
  cubic.exponent = 3;
  const Spline g = fit(sites, data, cubic);
  EXPECT_NEAR(Factorisation(sites, cubic).coefficients(data)(0, 0), -0.0711294492, digits10);
  EXPECT_NEAR(g.scalar({0, 0, 0}), -1.0 / 12, 1e-13);
  EXPECT_NEAR(g.scalar({h, 0, h}), -0.2992358968, digits10);
  EXPECT_NEAR(g.scalar({0, 0, 0.5}), -0.2584735510, digits10);
  EXPECT_NEAR(g.scalar({0, 0, 2}), -0.9844550749, digits10);
}

TEST(Factorisation, ReproducesPolynomialsOfItsNullSpace) {
  for (double exponent : {1.0, 2.0, 2.5, 3.0, 4.0, 5.0}) {
    Sites sites;
    sites.points = random_points(40, 1);
    Eigen::MatrixXd data(40, 2);
    for (int i = 0; i < 40; ++i) {
      const Vec3& p = sites.points[i];
      data.row(i) << 2 + p.x() - 3 * p.y() + 0.5 * p.z(), p.z();
    }
    SplineOptions options;
    options.exponent = exponent;
    const Spline f = fit(sites, data, options);
    EXPECT_LT(f.seminorm_squared(), 1e-12) << exponent;
    for (const Vec3& p : random_points(10, 2)) {
      EXPECT_NEAR(f.value(3 * p)[0], 2 + 3 * (p.x() - 3 * p.y() + 0.5 * p.z()), 1e-10) << exponent;
      EXPECT_NEAR(f.jacobian(p)(0, 1), -3, 1e-10);
    }
  }
}

TEST(Factorisation, InterpolatesValuesAndGradientsTogether) {
  for (double exponent : {2.5, 3.0, 3.5, 4.0, 5.0}) {
    Sites sites;
    sites.points = random_points(25, 3);
    for (const Vec3& p : random_points(10, 4))
      sites.add_gradient(p);
    sites.add_gradient(sites.points[0]);
    const Eigen::MatrixXd data = Eigen::MatrixXd::Random(sites.rows(), 1);
    SplineOptions options;
    options.exponent = exponent;
    const Spline f = fit(sites, data, options);
    for (int i = 0; i < 25; ++i)
      EXPECT_NEAR(f.scalar(sites.points[i]), data(i), 1e-9);
    for (int j = 0; j < sites.derivative_count(); ++j) {
      Vec3 gradient;
      f.value_and_gradient(sites.derivative_points[j], gradient);
      EXPECT_NEAR(gradient.dot(sites.derivative_directions[j]), data(25 + j), 1e-8) << exponent;
    }
  }
}

TEST(Factorisation, GradientAndHessianMatchFiniteDifferences) {
  for (double exponent : {3.0, 3.5, 4.0, 5.0}) {
    Sites sites;
    sites.points = random_points(15, 5);
    sites.add_gradient(Vec3(0.1, 0.2, 0.3));
    SplineOptions options;
    options.exponent = exponent;
    const Spline f = fit(sites, Eigen::MatrixXd::Random(18, 1), options);
    const double step = 1e-5;
    for (const Vec3& p : random_points(5, 6)) {
      Vec3 gradient;
      const double value = f.value_and_gradient(p, gradient);
      EXPECT_NEAR(value, f.value(p)[0], 1e-12 * (1 + std::abs(value)));
      const Mat3 hessian = f.hessian(p);
      for (int axis = 0; axis < 3; ++axis) {
        const Vec3 h = step * Vec3::Unit(axis);
        Vec3 ahead, behind;
        const double difference = f.value_and_gradient(p + h, ahead) - f.value_and_gradient(p - h, behind);
        EXPECT_NEAR(gradient[axis], difference / (2 * step), 1e-6 * (1 + gradient.norm()));
        EXPECT_LT((hessian.col(axis) - (ahead - behind) / (2 * step)).norm(), 1e-5 * (1 + hessian.norm()))
            << exponent;
      }
    }
  }
}

TEST(Factorisation, SolutionDoesNotDependOnUnitsOrOrigin) {
  for (double exponent : {1.0, 3.0, 4.0}) {
    Sites sites;
    sites.points = random_points(30, 7);
    const Eigen::MatrixXd data = Eigen::MatrixXd::Random(30, 1);
    SplineOptions options;
    options.exponent = exponent;
    options.lambda = 0.01;
    const Spline metres = fit(sites, data, options);
    Sites moved = sites;
    for (Vec3& p : moved.points)
      p = 1000 * p + Vec3(300, -200, 5000);
    // c^T K c of f(x/1000) is 1000^-exponent times that of f.
    options.lambda = 0.01 * std::pow(1000, exponent);
    const Spline scaled = fit(moved, data, options);
    for (const Vec3& p : random_points(5, 8))
      EXPECT_NEAR(metres.scalar(p), scaled.scalar(1000 * p + Vec3(300, -200, 5000)), 1e-7) << exponent;
  }
}

TEST(Smoothing, LimitsAreInterpolationAndLeastSquares) {
  Sites sites;
  sites.points = random_points(50, 9);
  sites.weights.assign(50, 1);
  for (int i = 0; i < 10; ++i)
    sites.weights[i] = 4;
  const Eigen::MatrixXd data = Eigen::MatrixXd::Random(50, 1);
  SplineOptions options;
  options.lambda = 1e-13;
  const Spline tight = fit(sites, data, options);
  for (int i = 0; i < 50; ++i)
    EXPECT_NEAR(tight.scalar(sites.points[i]), data(i), 1e-9);

  options.lambda = 1e9;
  const Spline loose = fit(sites, data, options);
  Eigen::MatrixXd A(50, 4);
  Eigen::VectorXd w(50);
  for (int i = 0; i < 50; ++i) {
    A.row(i) << 1, sites.points[i].transpose();
    w[i] = sites.weights[i];
  }
  const Eigen::VectorXd affine =
      (A.transpose() * w.asDiagonal() * A).ldlt().solve(A.transpose() * (w.asDiagonal() * data));
  for (const Vec3& p : random_points(5, 10))
    EXPECT_NEAR(loose.scalar(p), affine[0] + affine.tail<3>().dot(p), 1e-6);
}

TEST(Smoothing, IsTheMinimiser) {
  // The penalised sum grows whichever datum the fit is bent towards.
  Sites sites;
  sites.points = random_points(20, 11);
  const Eigen::MatrixXd data = Eigen::MatrixXd::Random(20, 1);
  SplineOptions options;
  options.exponent = 3;
  options.lambda = 0.1;
  const auto objective = [&](const Spline& f) {
    double sum = options.lambda * f.coefficients().energy;
    for (int i = 0; i < 20; ++i)
      sum += std::pow(data(i) - f.scalar(sites.points[i]), 2);
    return sum;
  };
  const double best = objective(fit(sites, data, options));
  SplineOptions exact = options;
  exact.lambda = 0;
  Eigen::MatrixXd fitted(20, 1);
  const Spline smooth = fit(sites, data, options);
  for (int i = 0; i < 20; ++i)
    fitted(i) = smooth.scalar(sites.points[i]);
  for (int i = 0; i < 20; ++i)
    for (double nudge : {-0.01, 0.01}) {
      Eigen::MatrixXd other = fitted;
      other(i) += nudge;
      EXPECT_GT(objective(fit(sites, other, exact)), best);
    }
}

TEST(Factorisation, PointsOnAPlaneLineOrSingleSpotLeaveTheRestConstant) {
  Sites sites;
  for (const Vec3& p : random_points(12, 12, true))
    sites.points.push_back(Vec3(p.x(), p.y(), 0.5 * p.x()));
  Eigen::MatrixXd data(12, 1);
  for (int i = 0; i < 12; ++i)
    data(i) = sites.points[i].x();
  const Factorisation flat(sites, {});
  EXPECT_EQ(flat.polynomial_rank(), 3);
  const Spline f = flat.solve(data);
  Vec3 gradient;
  f.value_and_gradient(Vec3(0.3, 0.1, 0.15), gradient);
  EXPECT_NEAR(gradient.dot(Vec3(-0.5, 0, 1).normalized()), 0, 1e-9);
  EXPECT_NEAR(gradient.dot(Vec3(1, 0, 0.5)), 1, 1e-9);

  Sites two;
  two.points = {{0, 0, 0}, {2, 2, 0}};
  const Spline line = fit(two, Eigen::Vector2d(1, 3), {});
  EXPECT_NEAR(line.scalar({1, 1, 0}), 2, 1e-12);
  EXPECT_NEAR(line.scalar({2, 0, 5}), 2, 1e-12);

  Sites one;
  one.points = {{4, 5, 6}};
  EXPECT_NEAR(fit(one, Eigen::MatrixXd::Constant(1, 1, 7), {}).scalar({-1, 0, 2}), 7, 1e-12);
}

std::string message(const Sites& sites, const SplineOptions& options) {
  try {
    Factorisation factorisation(sites, options);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(Factorisation, NamesTheDataAtFault) {
  Sites sites;
  sites.points = random_points(10, 20);
  sites.points[8] = sites.points[2];
  EXPECT_NE(message(sites, {}).find("data 2 and 8 are at the same point"), std::string::npos)
      << message(sites, {});
  sites.points[8] = sites.points[2] + Vec3(1e-17, 0, 0);
  SplineOptions options;
  options.exponent = 5;
  sites.points[2] = Vec3(0.1, 0.2, 0.3);
  sites.points[8] = Vec3(0.1 + 1e-15, 0.2, 0.3);
  EXPECT_NE(message(sites, options).find("data 2 and 8"), std::string::npos) << message(sites, options);

  Sites line;
  for (int i = 0; i < 6; ++i)
    line.points.emplace_back(i, 2 * i, 0);
  EXPECT_EQ(message(line, {}), "");
  options = {};
  options.require_full_rank = true;
  EXPECT_NE(message(line, options).find("only 2 of the 4 polynomial terms"), std::string::npos)
      << message(line, options);
}

TEST(Factorisation, RejectsSingularSystems) {
  Sites sites;
  EXPECT_THROW(Factorisation(sites, {}), Error);
  sites.points = random_points(10, 13);
  SplineOptions options;
  sites.points[3] = sites.points[7];
  EXPECT_THROW(Factorisation(sites, options), Error);
  options.lambda = 0.1;
  EXPECT_NO_THROW(Factorisation(sites, options));
  sites.points[3].x() = std::nan("");
  EXPECT_THROW(Factorisation(sites, options), Error);
  sites.points = random_points(10, 13);
  options.lambda = 0;
  sites.add_gradient(Vec3(0, 0, 0));
  EXPECT_THROW(Factorisation(sites, options), Error) << "exponent 1 has no gradient";
  options.exponent = 3;
  EXPECT_NO_THROW(Factorisation(sites, options));
  sites.derivative_points.push_back(Vec3(0, 0, 0));
  sites.derivative_directions.push_back(Vec3(1, 1, 0));
  EXPECT_THROW(Factorisation(sites, options), Error) << "four directions in space";
  sites.derivative_directions.back().setZero();
  EXPECT_THROW(Factorisation(sites, options), Error);
  options.exponent = 0;
  EXPECT_THROW(Factorisation(sites, options), Error);
  options.exponent = 11;
  EXPECT_THROW(Factorisation(sites, options), Error);
  Sites plain;
  plain.points = random_points(5, 14);
  plain.weights = {1, 1, 0, 1, 1};
  EXPECT_THROW(Factorisation(plain, {}), Error);
  plain.weights = {1};
  EXPECT_THROW(Factorisation(plain, {}), Error);
}

}  // namespace
}  // namespace fascia::splines
