#include "builder/splines/sliding.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "geometry/error.h"
#include "tests/splines/scatter.h"

namespace fascia::splines {
namespace {

Eigen::MatrixXd as_matrix(const std::vector<Vec3>& points) {
  Eigen::MatrixXd out(static_cast<Eigen::Index>(points.size()), 3);
  for (size_t i = 0; i < points.size(); ++i)
    out.row(static_cast<Eigen::Index>(i)) = points[i].transpose();
  return out;
}

// The independent computation slid an affine image back from 0.036261 to -2e-15, error 3.5e-15.
TEST(Relax, TangentialNoiseOnAnAffineImageIsRemovedExactly) {
  const std::vector<Vec3> source = scattered(30, 1);
  Mat3 A;
  A << 1.1, 0.2, -0.1, 0.05, 0.9, 0.1, -0.2, 0.1, 1.2;
  std::vector<Vec3> target, noisy;
  std::vector<Freedom> freedoms;
  const std::vector<Vec3> noise = scattered(30, 2);
  for (int i = 0; i < 30; ++i) {
    target.push_back(A * source[i] + Vec3(1, 2, 3));
    noisy.push_back(target.back());
    if (i < 12) continue;  // landmarks
    const auto frame = tangents(noise[i]);
    freedoms.push_back({i, frame[0]});
    noisy.back() += 0.2 * noise[i].x() * frame[0];
    if (i % 2 == 0) continue;  // a curve
    freedoms.push_back({i, frame[1]});
    noisy.back() += 0.2 * noise[i].y() * frame[1];
  }
  Sites sites;
  sites.points = source;
  const RelaxResult result = relax(Factorisation(sites, {}).bending_matrix(), as_matrix(noisy), freedoms);
  EXPECT_GT(result.energy_before, 1e-3);
  EXPECT_NEAR(result.energy_after, 0, 1e-13);
  EXPECT_LT((result.data - as_matrix(target)).cwiseAbs().maxCoeff(), 2e-12);
}

TEST(Relax, IsTheMinimumAndTheEnergyIsTheSplines) {
  Sites sites;
  sites.points = scattered(20, 3);
  const Eigen::MatrixXd data = as_matrix(scattered(20, 4));
  const Factorisation factorisation(sites, {});
  const Eigen::MatrixXd bending = factorisation.bending_matrix();
  std::vector<Freedom> freedoms;
  for (int i = 0; i < 8; ++i)
    freedoms.push_back({i, scattered(8, 5)[i]});
  const RelaxResult result = relax(bending, data, freedoms);
  EXPECT_NEAR(result.energy_before, factorisation.solve(data).coefficients().energy, 1e-9);
  EXPECT_NEAR(result.energy_after, factorisation.solve(result.data).coefficients().energy, 1e-9);
  EXPECT_LT(result.energy_after, result.energy_before);
  // Stationary: the force B y has no part along any freedom.
  const Eigen::MatrixXd force = bending * result.data;
  for (const Freedom& freedom : freedoms)
    EXPECT_NEAR(force.row(freedom.row).dot(freedom.direction), 0, 1e-10);
}

TEST(Relax, WithDerivativeRowsAndUnitsOfTheUser) {
  Sites sites;
  sites.points = scattered(15, 6);
  for (Vec3& p : sites.points)
    p = 50 * p + Vec3(10, 0, 0);
  sites.add_tangents(Vec3(1, 2, 3), Vec3(0, 1, 1));
  SplineOptions options;
  options.exponent = 3;
  const Factorisation factorisation(sites, options);
  const Eigen::MatrixXd data = Eigen::MatrixXd::Random(17, 2);
  const double energy = (data.transpose() * factorisation.bending_matrix() * data).trace();
  EXPECT_NEAR(energy / factorisation.solve(data).coefficients().energy, 1, 1e-9);
  const Eigen::MatrixXd coefficients = factorisation.coefficients(data);
  EXPECT_LT((factorisation.bending_matrix() * data - coefficients.topRows(17)).norm(),
            1e-9 * coefficients.norm());
}

TEST(Relax, AllPointsMaySlide) {
  Sites sites;
  sites.points = scattered(10, 7);
  std::vector<Freedom> freedoms;
  for (int i = 0; i < 10; ++i)
    for (int axis = 0; axis < 3; ++axis)
      freedoms.push_back({i, Vec3::Unit(axis)});
  const RelaxResult result =
      relax(Factorisation(sites, {}).bending_matrix(), as_matrix(scattered(10, 8)), freedoms);
  EXPECT_NEAR(result.energy_after, 0, 1e-9);
  EXPECT_LT(result.steps.norm(), 100);
  EXPECT_THROW(relax(Eigen::MatrixXd::Zero(3, 3), Eigen::MatrixXd::Zero(4, 3), freedoms), Error);
  EXPECT_THROW(relax(Eigen::MatrixXd::Identity(3, 3), Eigen::MatrixXd::Zero(3, 3), freedoms), Error);
}

// Points slid away along an ellipse come back to where the affine map of the circle puts them.
TEST(Slide, CurvesAreRecoveredFromAnAffineImage) {
  const auto ellipse = [](double t) {
    return Vec3(1.6 * std::cos(t) + 0.3 * std::sin(t), 0.8 * std::sin(t), 0);
  };
  std::vector<Vec3> outline;
  for (int i = 0; i < 720; ++i)
    outline.push_back(ellipse(i * std::numbers::pi / 360));
  SlidingLandmarks landmarks;
  std::vector<Vec3> truth;
  for (int i = 0; i < 16; ++i) {
    const double t = i * std::numbers::pi / 8;
    landmarks.source.emplace_back(std::cos(t), std::sin(t), 0);
    truth.push_back(ellipse(t));
    const bool fixed = i % 4 == 0;
    landmarks.carrier.push_back(fixed ? -1 : 0);
    landmarks.target.push_back(fixed ? truth.back() : ellipse(t + 0.15 * std::sin(3.0 * i)));
  }
  const std::vector<Carrier> carriers = {polyline_carrier(outline, true)};
  SlidingOptions options;
  options.dimension = 2;
  options.exponent = 2;
  options.tolerance = 1e-9;
  const SlidingResult result = slide(landmarks, carriers, options);
  EXPECT_TRUE(result.converged);
  EXPECT_GT(result.energy_before, 0.01);
  EXPECT_LT(result.energy_after, 1e-5 * result.energy_before);
  for (int i = 0; i < 16; ++i)
    EXPECT_LT((result.target[i] - truth[i]).norm(), 2e-3) << i;
}

TEST(Slide, SurfacesAreRecoveredFromAnAffineImage) {
  const Vec3 axes(1.3, 0.9, 1.1);
  // The nearest point of an ellipsoid along the ray from its centre is near enough to slide on.
  Carrier surface;
  surface.kind = Carrier::Kind::surface;
  surface.nearest = [axes](const Vec3& p) {
    const Vec3 q = p.cwiseQuotient(axes).normalized();
    return Foot{q.cwiseProduct(axes), q.cwiseQuotient(axes).normalized()};
  };
  SlidingLandmarks landmarks;
  std::vector<Vec3> truth;
  const std::vector<Vec3> points = scattered(40, 9), noise = scattered(40, 10);
  for (int i = 0; i < 40; ++i) {
    landmarks.source.push_back(points[i].normalized());
    truth.push_back(landmarks.source.back().cwiseProduct(axes));
    landmarks.carrier.push_back(i < 14 ? -1 : 0);
    landmarks.target.push_back(i < 14 ? truth.back()
                                      : surface.nearest(truth.back() + 0.1 * noise[i]).position);
  }
  SlidingOptions options;
  options.tolerance = 1e-10;
  options.iterations = 100;
  const std::vector<Carrier> carriers = {surface};
  const SlidingResult result = slide(landmarks, carriers, options);
  EXPECT_LT(result.energy_after, 1e-6 * result.energy_before);
  for (int i = 0; i < 40; ++i) {
    EXPECT_LT((result.target[i] - truth[i]).norm(), 1e-3) << i;
    EXPECT_NEAR(result.target[i].cwiseQuotient(axes).norm(), 1, 1e-12);
  }
}

TEST(Slide, NeverPassesANeighbourAndNeverRaisesTheEnergy) {
  SlidingLandmarks landmarks;
  for (int i = 0; i <= 10; ++i) {
    landmarks.source.emplace_back(i, 0, 0);
    landmarks.source.emplace_back(i, 1, 0);
    landmarks.target.emplace_back(i, 0, 0);
    // Crowded at the left end.
    landmarks.target.emplace_back(i == 10 ? 10 : 0.3 * i, 1 + 0.2 * std::sin(0.3 * i), 0);
    landmarks.carrier.insert(landmarks.carrier.end(), {-1, i == 0 || i == 10 ? -1 : 0});
  }
  std::vector<Vec3> curve;
  for (int i = 0; i <= 200; ++i)
    curve.emplace_back(0.05 * i, 1 + 0.2 * std::sin(0.05 * i), 0);
  const std::vector<Carrier> carriers = {polyline_carrier(curve)};
  SlidingOptions options;
  options.dimension = 2;
  options.exponent = 2;
  options.iterations = 1;
  double energy = 1e300;
  for (int step = 0; step < 30; ++step) {
    const SlidingResult result = slide(landmarks, carriers, options);
    EXPECT_LE(result.energy_after, result.energy_before);
    EXPECT_LE(result.energy_after, energy + 1e-9);
    energy = result.energy_after;
    landmarks.target = result.target;
    for (int i = 1; i <= 10; ++i)
      EXPECT_GT(landmarks.target[2 * i + 1].x(), landmarks.target[2 * i - 1].x()) << step << ' ' << i;
  }
  EXPECT_NEAR(landmarks.target[11].x(), 5, 0.5);
}

TEST(Slide, RejectsMismatchedInput) {
  SlidingLandmarks landmarks;
  landmarks.source = scattered(6, 11);
  landmarks.target = landmarks.source;
  landmarks.carrier.assign(5, -1);
  EXPECT_THROW(slide(landmarks, {}), Error);
  landmarks.carrier.assign(6, 0);
  EXPECT_THROW(slide(landmarks, {}), Error);
  EXPECT_THROW(polyline_carrier({Vec3(1, 2, 3)}), Error);
  EXPECT_THROW(polyline_carrier({Vec3(1, 2, 3), Vec3(1, 2, 3)}), Error);
}

}  // namespace
}  // namespace fascia::splines
