#include "builder/splines/smoothing.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <random>

#include "geometry/error.h"
#include "tests/splines/scatter.h"

namespace fascia::splines {
namespace {

SplineOptions plate() {
  SplineOptions options;
  options.dimension = 2;
  options.exponent = 2;
  return options;
}

double truth(const Vec3& p) {
  return std::sin(3 * p.x()) * std::cos(2 * p.y());
}

struct Noisy {
  Sites sites;
  Eigen::MatrixXd data;
  Noisy(int count, double deviation) : data(count, 1) {
    sites.points = scattered(count, 1, true);
    std::mt19937 random(2);
    std::normal_distribution<double> normal(0, deviation);
    for (int i = 0; i < count; ++i)
      data(i) = truth(sites.points[i]) + normal(random);
  }
};

// The influence matrix column by column: the smooth of each unit vector.
TEST(CrossValidation, EqualsItsDefinition) {
  for (double exponent : {2.0, 3.0}) {
    Noisy noisy(30, 0.1);
    noisy.sites.weights.assign(30, 1);
    for (int i = 0; i < 10; ++i)
      noisy.sites.weights[i] = 3;
    SplineOptions options = plate();
    options.exponent = exponent;
    const SmoothingPath path(noisy.sites, noisy.data, options);
    for (double lambda : {1e-4, 1e-2, 1.0}) {
      options.lambda = lambda;
      const Factorisation factorisation(noisy.sites, options);
      const Spline unit = factorisation.solve(Eigen::MatrixXd::Identity(30, 30));
      const Eigen::MatrixXd A = unit.values(noisy.sites.points);
      const Eigen::VectorXd left = noisy.data - A * noisy.data;
      double weighted = 0;
      for (int i = 0; i < 30; ++i)
        weighted += noisy.sites.weights[i] * left[i] * left[i];
      const double trace = 30 - A.trace();
      const CrossValidation found = path.at(lambda);
      EXPECT_NEAR(found.score / (30 * weighted / (trace * trace)), 1, 1e-7) << lambda;
      EXPECT_NEAR(found.degrees_of_freedom, A.trace(), 1e-7);
    }
  }
}

TEST(CrossValidation, FindsNoiseAndSignal) {
  const double deviation = 0.2;
  const Noisy noisy(300, deviation);
  SplineOptions options = plate();
  const CrossValidation chosen = choose_lambda(noisy.sites, noisy.data, options);
  EXPECT_FALSE(chosen.at_bound);
  EXPECT_NEAR(std::sqrt(chosen.variance), deviation, 0.02);
  const auto error = [&](double lambda) {
    options.lambda = lambda;
    const Spline f = fit(noisy.sites, noisy.data, options);
    double sum = 0;
    for (const Vec3& p : scattered(500, 3, true))
      sum += std::pow(f.scalar(0.9 * p) - truth(0.9 * p), 2);
    return std::sqrt(sum / 500);
  };
  const double at_chosen = error(chosen.lambda);
  EXPECT_LT(at_chosen, 0.4 * error(1e-9));
  EXPECT_LT(at_chosen, 0.4 * error(1e6));
  for (double factor : {0.03, 0.1, 10.0, 30.0})
    EXPECT_LT(at_chosen, 1.1 * error(factor * chosen.lambda)) << factor;
  // The score has its minimum there.
  const SmoothingPath path(noisy.sites, noisy.data, options);
  for (double factor : {0.5, 0.9, 1.1, 2.0})
    EXPECT_GE(path.at(factor * chosen.lambda).score, chosen.score);
}

TEST(CrossValidation, ExactDataAskForNoSmoothingAndPureNoiseForAPlane) {
  Noisy noisy(60, 0);
  EXPECT_LT(choose_lambda(noisy.sites, noisy.data, plate()).lambda, 1e-4);
  std::mt19937 random(4);
  std::normal_distribution<double> normal(0, 1);
  for (int i = 0; i < 60; ++i)
    noisy.data(i) = noisy.sites.points[i].x() + normal(random);
  EXPECT_LT(choose_lambda(noisy.sites, noisy.data, plate()).degrees_of_freedom, 12);
}

TEST(CrossValidation, RejectsInvalidInput) {
  Noisy noisy(12, 0.1);
  noisy.sites.weights.assign(12, 1);
  noisy.sites.weights[3] = std::numeric_limits<double>::infinity();
  EXPECT_THROW(choose_lambda(noisy.sites, noisy.data, plate()), Error);
  Noisy few(3, 0.1);
  EXPECT_THROW(choose_lambda(few.sites, few.data, plate()), Error);
}

TEST(Duchon, OptionsMatchTheSeminorm) {
  const SplineOptions plane = duchon_options(2, 2);
  EXPECT_EQ(plane.exponent, 2);
  EXPECT_EQ(plane.degree, 1);
  EXPECT_EQ(duchon_options(3, 2).exponent, 1);
  EXPECT_EQ(duchon_options(3, 2, 1).exponent, 3);
  EXPECT_EQ(duchon_options(2, 2, 0.75).exponent, 3.5);
  EXPECT_EQ(duchon_options(3, 3, 1).degree, 2);
  EXPECT_THROW(duchon_options(3, 1), Error) << "m + s must exceed d / 2";
  EXPECT_THROW(duchon_options(2, 2, 1), Error) << "s must stay below d / 2";
  // The null space is enough for the kernel whenever the seminorm is one.
  for (int dimension : {2, 3})
    for (int derivatives = 1; derivatives <= 4; ++derivatives)
      for (double s = -1; s < 0.5 * dimension; s += 0.25) {
        if (derivatives + s <= 0.5 * dimension) continue;
        const SplineOptions options = duchon_options(dimension, derivatives, s);
        EXPECT_GE(options.degree, Kernel(options.exponent).required_degree());
      }
}

// |f|^2 = integral of fxx^2 + 2 fxy^2 + fyy^2 over the plane, by quadrature in rings.
TEST(Duchon, TheSeminormIsTheBendingEnergy) {
  Sites sites;
  sites.points = {{0.5, 0.1, 0}, {-0.4, 0.5, 0}, {-0.3, -0.6, 0}, {0.4, -0.4, 0}, {0.1, 0.2, 0}};
  Eigen::MatrixXd data(5, 1);
  data << 0.3, -0.2, 0.5, -0.4, 0.6;
  const Spline f = fit(sites, data, plate());
  const int rings = 700, sectors = 240;
  double sum = 0;
  for (int i = 0; i < rings; ++i) {
    const double low = -7, high = 7, step = (high - low) / rings;
    const double radius = std::exp(low + (i + 0.5) * step);
    double around = 0;
    for (int j = 0; j < sectors; ++j) {
      const double angle = 2 * 3.14159265358979 * (j + 0.5) / sectors;
      const Mat3 H = f.hessian(Vec3(radius * std::cos(angle), radius * std::sin(angle), 0));
      around += H.topLeftCorner<2, 2>().squaredNorm();
    }
    sum += around * 2 * 3.14159265358979 / sectors * radius * radius * step;
  }
  EXPECT_NEAR(sum / f.seminorm_squared(), 1, 0.01);
}

// K of values and gradients is definite on the null space exactly when that is large enough.
TEST(Duchon, HermiteFormsAreDefiniteWithTheirNullSpace) {
  struct Case {
    double exponent;
    int dimension, degree;
    bool definite;
  };
  for (const Case& c : {Case{3, 3, 1, true}, Case{3, 2, 1, true}, Case{3.5, 2, 1, true}, Case{4, 2, 2, true},
                        Case{4, 2, 1, false}, Case{5, 3, 2, true}, Case{2.5, 3, 1, true}}) {
    Sites sites;
    sites.points = scattered(20, 5, c.dimension == 2);
    for (int i = 0; i < 10; ++i)
      sites.add_gradient(sites.points[i], c.dimension);
    SplineOptions options;
    options.dimension = c.dimension;
    options.exponent = c.exponent;
    options.degree = c.degree;
    const Factorisation factorisation(sites, options);
    const Eigen::MatrixXd B = factorisation.bending_matrix();
    const Eigen::VectorXd eigenvalues = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(B).eigenvalues();
    const double largest = eigenvalues.cwiseAbs().maxCoeff();
    EXPECT_GT(eigenvalues.maxCoeff(), 1e-6 * largest);
    if (c.definite) {
      EXPECT_GT(eigenvalues.minCoeff(), -1e-9 * largest) << c.exponent;
    } else {
      EXPECT_LT(eigenvalues.minCoeff(), -1e-6 * largest) << c.exponent;
    }
  }
}

}  // namespace
}  // namespace fascia::splines
