// A take of any length as few shapes: motions whose rank is known, curves whose corners are known.
#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <cmath>
#include <random>

#include "cli/take/components.h"
#include "cli/take/keyframes.h"
#include "cli/take/product.h"
#include "cli/take/product_loops.h"
#include "cli/take/weight_fit.h"

namespace fascia::cli {
namespace {

using Eigen::Index;
using Eigen::MatrixXf;

/// Frames of `rank` smooth shapes on a strip of vertices, of which the last quarter stands still; the shapes'
/// strengths fall from 10 mm by halves.
class Strip {
 public:
  Strip(Index vertices, Index rank) : shapes_(MatrixXf::Zero(3 * vertices, rank)) {
    for (Index k = 0; k < rank; ++k)
      for (Index v = 0; v < vertices - vertices / 4; ++v)
        for (Index axis = 0; axis < 3; ++axis)
          shapes_(3 * v + axis, k) = 0.01F * std::pow(0.5F, static_cast<float>(k)) *
                                     std::cos(0.1F * static_cast<float>((k + 1) * v + 7 * axis * (k + 2)) /
                                              std::sqrt(static_cast<float>(rank)));
  }
  Eigen::VectorXf frame(size_t f) const {
    Eigen::VectorXf weights(shapes_.cols());
    for (Index k = 0; k < weights.size(); ++k)
      weights[k] = std::sin(0.013F * static_cast<float>(k + 1) * static_cast<float>(f));
    return shapes_ * weights;
  }

 private:
  MatrixXf shapes_;
};

MotionSpace space_of(const Strip& strip, size_t vertices, size_t frames, MotionSpace::Options options) {
  MotionSpace space(vertices, options);
  for (size_t f = 0; f < frames; ++f) {
    const Eigen::VectorXf frame = strip.frame(f);
    space.add({frame.data(), static_cast<size_t>(frame.size())});
  }
  space.finish();
  return space;
}

/// The shapes of `parts` with weights fitted to the strip's frames, and `more` further ones at most.
WeightFit::Result fitted(const MotionSpace& space, const Components& parts, const Strip& strip, size_t frames,
                         double tolerance = 0.0, size_t more = 0) {
  WeightFit fit(space.vertices(), parts, {tolerance, more});
  for (size_t f = 0; f < frames; ++f) {
    const Eigen::VectorXf frame = strip.frame(f);
    fit.add({frame.data(), static_cast<size_t>(frame.size())});
  }
  return fit.finish();
}

MatrixXf matrix_of(const std::vector<Eigen::VectorXf>& columns) {
  MatrixXf matrix(columns.empty() ? 0 : columns[0].size(), static_cast<Index>(columns.size()));
  for (Index k = 0; k < matrix.cols(); ++k)
    matrix.col(k) = columns[static_cast<size_t>(k)];
  return matrix;
}

/// How far at most shapes with weights are off a frame of the strip at any vertex.
float error_of(const MotionSpace& space, const MatrixXf& shapes, const MatrixXf& weights, const Strip& strip,
               size_t f) {
  const Eigen::VectorXf frame = strip.frame(f);
  const Eigen::VectorXf made = shapes * weights.col(static_cast<Index>(f));
  float largest = 0.0F;
  for (size_t i = 0; i < space.vertices().size(); ++i) {
    const Eigen::Vector3f there = shapes.cols() == 0
                                      ? Eigen::Vector3f(Eigen::Vector3f::Zero())
                                      : Eigen::Vector3f(made.segment<3>(static_cast<Index>(3 * i)));
    largest = std::max(largest, (frame.segment<3>(3 * space.vertices()[i]) - there).norm());
  }
  return largest;
}

float error_of(const MotionSpace& space, const MatrixXf& shapes, const MatrixXf& weights,
               const Strip& strip) {
  float largest = 0.0F;
  for (Index f = 0; f < weights.cols(); ++f)
    largest = std::max(largest, error_of(space, shapes, weights, strip, static_cast<size_t>(f)));
  return largest;
}

TEST(Take, AMotionOfKnownRankIsFoundForAnyLength) {
  for (const size_t frames : {1UL, 5UL, 40UL, 3000UL}) {
    const Strip strip(400, 6);
    MotionSpace::Options options;
    options.tolerance = 1e-6;
    options.sampled_vertices = 100;
    const MotionSpace space = space_of(strip, 400, frames, options);
    EXPECT_EQ(space.vertices().size(), frames > 1 ? 300U : 0U);  // the first frame is the rest
    EXPECT_LE(space.coefficients().rows(), 8);
    const Components parts = components(space, 64, 1e-5);
    EXPECT_LE(parts.shapes.size(), 6U);
    const WeightFit::Result fit = fitted(space, parts, strip, frames);
    EXPECT_EQ(fit.weights.cols(), static_cast<Index>(frames));
    EXPECT_LE(error_of(space, matrix_of(fit.shapes), fit.weights, strip), 2e-5) << frames;
    EXPECT_TRUE((fit.weights.array().abs() <= 1.0F + 1e-5F).all());
  }
}

TEST(Take, WhatIsLeftOfEachFrameIsMeasured) {
  const Strip strip(400, 12);
  MotionSpace::Options options;
  options.tolerance = 1e-7;
  const MotionSpace space = space_of(strip, 400, 300, options);
  for (const size_t more : {0UL, 3UL}) {
    const WeightFit::Result fit = fitted(space, components(space, 4, 1e-6), strip, 300, 1e-6, more);
    EXPECT_EQ(fit.shapes.size(), 4 + more);
    const MatrixXf shapes = matrix_of(fit.shapes);
    for (size_t f = 0; f < 300; ++f)
      EXPECT_NEAR(fit.left[f], error_of(space, shapes, fit.weights, strip, f), 1e-7) << f;
  }
}

TEST(Take, FurtherShapesBringEveryFrameWithinTheTolerance) {
  const Strip strip(400, 12);
  MotionSpace::Options options;
  options.tolerance = 1e-7;
  const MotionSpace space = space_of(strip, 400, 900, options);
  const Components parts = components(space, 3, 1e-6);
  const WeightFit::Result fit = fitted(space, parts, strip, 900, 1e-5, 100);
  EXPECT_LE(error_of(space, matrix_of(fit.shapes), fit.weights, strip), 1.02e-5);
  EXPECT_LE(fit.shapes.size(), 13U) << "the motion has twelve dimensions";
  EXPECT_GT(error_of(space, matrix_of(fitted(space, parts, strip, 900).shapes),
                     fitted(space, parts, strip, 900).weights, strip),
            1e-4);
}

TEST(Take, OfALongTakeFewFramesAreKept) {
  const Strip strip(400, 6);
  MotionSpace::Options options;
  options.tolerance = 1e-6;
  options.most_frames = 100;
  const MotionSpace space = space_of(strip, 400, 3000, options);
  EXPECT_LE(space.coefficients().cols(), 100);
  EXPECT_GE(space.coefficients().cols(), 50);
  const WeightFit::Result fit = fitted(space, components(space, 64, 1e-5), strip, 3000);
  EXPECT_EQ(fit.weights.cols(), 3000);
  EXPECT_LE(error_of(space, matrix_of(fit.shapes), fit.weights, strip), 2e-5);
}

TEST(Take, VerticesThatMoveOnlyLateAreIncluded) {
  MotionSpace::Options options;
  options.tolerance = 1e-6;
  MotionSpace space(40, options);
  const auto frame = [](int f) {
    std::vector<float> displacement(120, 0.0F);
    displacement[0] = 0.001F * static_cast<float>(f % 7);
    if (f >= 70) displacement[3 * 39 + 1] = 0.002F * static_cast<float>(f % 5);
    return displacement;
  };
  for (int f = 0; f < 100; ++f)
    space.add(frame(f));
  space.finish();
  ASSERT_EQ(space.vertices(), (std::vector<uint32_t>{0, 39}));
  const Components parts = components(space, 64, 1e-6);
  WeightFit fit(space.vertices(), parts, {});
  for (int f = 0; f < 100; ++f)
    fit.add(frame(f));
  const WeightFit::Result result = fit.finish();
  const MatrixXf made = matrix_of(result.shapes) * result.weights;
  EXPECT_NEAR(made(0, 75), 0.001F * (75 % 7), 2e-6);
  EXPECT_NEAR(made(4, 74), 0.002F * (74 % 5), 2e-6);
  EXPECT_NEAR(made(4, 69), 0.0F, 2e-6);
}

TEST(Take, TooFewComponentsAreChosenForTheLargestError) {
  const Strip strip(400, 12);
  MotionSpace::Options options;
  options.tolerance = 1e-7;
  const MotionSpace space = space_of(strip, 400, 900, options);
  const Components all = components(space, 64, 5e-6);
  EXPECT_EQ(all.wanted, all.shapes.size());
  float before = 1.0F;
  for (const size_t limit : {1UL, 2UL, 4UL, 6UL}) {
    const Components parts = components(space, limit, 5e-6);
    EXPECT_EQ(parts.shapes.size(), limit);
    EXPECT_EQ(parts.wanted, all.wanted);
    // The plain principal components of the same number, for comparison.
    const Eigen::JacobiSVD<MatrixXf> svd(space.coefficients(), Eigen::ComputeThinU);
    const MatrixXf turn = svd.matrixU().leftCols(static_cast<Index>(limit));
    const float plain = error_of(space, space.mixed(turn), turn.transpose() * space.coefficients(), strip);
    const WeightFit::Result fit = fitted(space, parts, strip, 900);
    const float error = error_of(space, matrix_of(fit.shapes), fit.weights, strip);
    EXPECT_LE(error, 0.8F * plain) << limit;
    EXPECT_LT(error, before);
    before = error;
  }
}

TEST(Take, FewDirectionsAreKeptWhereMemoryIsShort) {
  std::mt19937 random(7);
  std::normal_distribution<float> normal;
  MotionSpace::Options options;
  options.tolerance = 1e-7;
  options.most_directions = 128;
  MotionSpace space(300, options);
  MatrixXf basis = MatrixXf::NullaryExpr(
      900, 160, [&](Index, Index k) { return normal(random) * std::pow(0.9F, static_cast<float>(k)); });
  double lost = 0.0;
  MatrixXf frames(900, 700);
  for (Index f = 0; f < 700; ++f) {
    frames.col(f) = basis * Eigen::VectorXf::NullaryExpr(160, [&](Index) { return normal(random); });
    space.add({frames.col(f).data(), 900});
  }
  space.finish();
  EXPECT_LE(space.coefficients().rows(), 128);
  const MatrixXf made =
      space.mixed(MatrixXf::Identity(space.coefficients().rows(), space.coefficients().rows())) *
      space.coefficients();
  for (size_t i = 0; i < space.vertices().size(); ++i)
    lost =
        std::max(lost, static_cast<double>((made.middleRows<3>(static_cast<Index>(3 * i)) -
                                            frames.middleRows<3>(3 * static_cast<Index>(space.vertices()[i])))
                                               .cwiseAbs()
                                               .maxCoeff()));
  EXPECT_LT(lost, 20.0 * std::pow(0.9, 96));  // what three quarters of the directions cannot hold
}

TEST(Take, ToleranceGrowsForLongMotionsOfManyDimensions) {
  std::mt19937 random(3);
  std::normal_distribution<float> normal;
  const MatrixXf basis = MatrixXf::NullaryExpr(
      900, 120, [&](Index, Index k) { return normal(random) * std::pow(0.9F, static_cast<float>(k)); });
  MotionSpace::Options options;
  options.tolerance = 1e-3;
  options.fine_directions = 40;
  MotionSpace space(300, options);
  for (int f = 0; f < 600; ++f) {
    const Eigen::VectorXf frame =
        basis * Eigen::VectorXf::NullaryExpr(120, [&](Index) { return normal(random); });
    space.add({frame.data(), 900});
  }
  space.finish();
  EXPECT_LT(space.coefficients().rows(), 120);
  EXPECT_GT(space.tolerance(), 1e-3);
}

TEST(Take, AProductIsTheSameOnEveryVectorUnit) {
  std::mt19937 random(5);
  std::normal_distribution<float> normal;
  const MatrixXf matrix = MatrixXf::NullaryExpr(149, 9, [&](Index, Index) { return normal(random); });
  const MatrixXf mix = MatrixXf::NullaryExpr(9, 21, [&](Index, Index) { return normal(random); });
  MatrixXf plain = MatrixXf::Zero(149, 21);
  for (Index c = 0; c < 21; ++c)
    for (Index k = 0; k < 9; ++k)
      plain.col(c) += matrix.col(k) * mix(k, c);
  EXPECT_EQ(product(matrix, mix), plain);
  std::vector<const float*> columns;
  for (Index k = 0; k < 9; ++k)
    columns.push_back(matrix.col(k).data());
  MatrixXf out(149, 21);
  std::vector<float> scratch(product_rows * 9);
  const ProductParts parts = {columns.data(), 149, 9, mix.data(), 21, out.data(), scratch.data()};
  product_baseline(parts);
  EXPECT_EQ(out, plain);
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2")) {
    out.setZero();
    product_avx2(parts);
    EXPECT_EQ(out, plain);
  }
  if (__builtin_cpu_supports("avx512f")) {
    out.setZero();
    product_avx512(parts);
    EXPECT_EQ(out, plain);
  }
#endif
}

/// `values` as they are between the kept frames: linear.
MatrixXf between_keys(const MatrixXf& values, const std::vector<size_t>& keys) {
  MatrixXf result = values;
  for (size_t k = 0; k + 1 < keys.size(); ++k)
    if (keys[k + 1] - keys[k] > 1)
      result.middleCols(static_cast<Index>(keys[k]) + 1, static_cast<Index>(keys[k + 1] - keys[k]) - 1) -=
          off_line(values, keys[k], keys[k + 1]);
  return result;
}

TEST(Keys, AreTheCornersOfStraightPieces) {
  MatrixXf values(2, 101);
  for (Index f = 0; f <= 100; ++f) {
    const auto t = static_cast<float>(f);
    values(0, f) = t < 30 ? t : t < 60 ? 30.0F : 90.0F - t;
    values(1, f) = t < 80 ? 0.0F : t - 80;
  }
  const std::vector<float> tolerances = {1e-3F, 1e-3F};
  EXPECT_EQ(keys_of(values, tolerances), (std::vector<size_t>{0, 30, 60, 80, 100}));
  EXPECT_EQ(keys_of(values.leftCols(1), tolerances), (std::vector<size_t>{0}));
  const std::vector<size_t> kept = keys_of(values, tolerances);
  EXPECT_LE((between_keys(values, kept) - values).cwiseAbs().maxCoeff(), 1e-4F);
}

TEST(Keys, LeaveShapesWithinTheirTolerance) {
  const Strip strip(100, 4);
  MotionSpace::Options options;
  options.tolerance = 1e-7;
  const MotionSpace space = space_of(strip, 100, 1000, options);
  const WeightFit::Result parts = fitted(space, components(space, 64, 1e-6), strip, 1000);
  const MatrixXf shapes = matrix_of(parts.shapes);
  size_t before = 1000;
  for (const double tolerance : {1e-5, 1e-4, 1e-3}) {
    const std::vector<size_t> kept = keys_of_shapes(parts.weights, shapes, tolerance);
    EXPECT_LT(kept.size(), before);
    before = kept.size();
    const MatrixXf off = shapes * (between_keys(parts.weights, kept) - parts.weights);
    for (Index f = 0; f < off.cols(); ++f)
      for (Index i = 0; i < off.rows(); i += 3)
        ASSERT_LE(off.col(f).segment<3>(i).norm(), 1.01 * tolerance);
  }
}

}  // namespace
}  // namespace fascia::cli
