#include "sim/front_factor.h"

#include <gtest/gtest.h>

#include <cmath>

namespace fascia::sim {
namespace {

/// A grid of nodes, each tied to its neighbours by a block that couples all three of its rows.
struct Grid {
  explicit Grid(int side) {
    Mat3 coupled;
    coupled << 1.0, 0.2, 0.1, 0.2, 1.0, 0.3, 0.1, 0.3, 1.0;
    std::vector<Eigen::Triplet<double>> entries;
    const auto add = [&](int row, int column, double share) {
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
          if (3 * row + i >= 3 * column + j)
            entries.emplace_back(3 * row + i, 3 * column + j, share * coupled(i, j));
    };
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        const int at = y * side + x;
        places.emplace_back(x, y, 0.1 * x * y);
        add(at, at, 4.1);
        if (x + 1 < side) add(at + 1, at, -1.0);
        if (y + 1 < side) add(at + side, at, -1.0);
      }
    lower.resize(3 * side * side, 3 * side * side);
    lower.setFromTriplets(entries.begin(), entries.end());
    whole = lower.selfadjointView<Eigen::Lower>();
  }
  Positions places;
  Eigen::SparseMatrix<double> lower, whole;
};

TEST(FrontFactor, GivesBackWhatTheMatrixMadeForAnyNumberOfColumns) {
  const Grid grid(13);
  FrontFactor factor;
  EXPECT_FALSE(factor.is_sound());
  ASSERT_TRUE(factor.compute(grid.lower, grid.places));
  for (const Eigen::Index columns : {0, 1, 7, 32, 70}) {
    Eigen::MatrixXd wanted(grid.whole.rows(), columns);
    for (Eigen::Index i = 0; i < wanted.size(); ++i)
      wanted.data()[i] = std::sin(1.7 * static_cast<double>(i));
    const Eigen::MatrixXd found = factor.solve((grid.whole * wanted).cast<float>()).cast<double>();
    ASSERT_EQ(found.cols(), columns);
    if (columns == 0) continue;
    EXPECT_LT((found - wanted).cwiseAbs().maxCoeff(), 2e-5) << columns << " columns";
  }
}

/// Half of a solve is L^-1 of the right side: products of two are those of the inverse.
TEST(FrontFactor, ForwardAndBackwardSubstitutionSolve) {
  const Grid grid(8);
  FrontFactor factor;
  ASSERT_TRUE(factor.compute(grid.lower, grid.places));
  FrontFactor::Dense right = FrontFactor::Dense::Zero(grid.whole.rows(), 40);
  for (Eigen::Index column = 0; column < right.cols(); ++column)
    right(4 * column, column) = 1.0F + 0.1F * static_cast<float>(column);
  const FrontFactor::Dense halfway = factor.forward(right), solution = factor.solve(right);
  ASSERT_EQ(halfway.rows(), right.cols());
  EXPECT_EQ(factor.backward(halfway), solution);
  EXPECT_LT((halfway * halfway.transpose() - right.transpose() * solution).cwiseAbs().maxCoeff(), 1e-5F);
}

TEST(FrontFactor, InPartsIsTheSameAsAtOnce) {
  const Grid grid(9);
  FrontFactor once, parts;
  ASSERT_TRUE(once.compute(grid.lower, grid.places));
  parts.begin(grid.lower, grid.places);
  int calls = 1;
  for (; !parts.advance(0.1 * parts.work()); ++calls)
    EXPECT_FALSE(parts.is_sound());
  EXPECT_GT(calls, 3);
  ASSERT_TRUE(parts.is_sound());
  const FrontFactor::Dense right = FrontFactor::Dense::Ones(grid.whole.rows(), 2);
  EXPECT_EQ(once.solve(right), parts.solve(right));
}

/// A new matrix of the same nodes, of the same pattern and of another.
TEST(FrontFactor, TakesAnotherMatrix) {
  Grid grid(7);
  FrontFactor factor;
  ASSERT_TRUE(factor.compute(grid.lower, grid.places));
  const auto check = [&](const Eigen::SparseMatrix<double>& lower) {
    const Eigen::SparseMatrix<double> whole = lower.selfadjointView<Eigen::Lower>();
    ASSERT_TRUE(factor.compute(lower, grid.places));
    const Eigen::MatrixXd wanted = Eigen::MatrixXd::Ones(whole.rows(), 1);
    EXPECT_LT((factor.solve((whole * wanted).cast<float>()).cast<double>() - wanted).cwiseAbs().maxCoeff(),
              2e-5);
  };
  check(2.0 * grid.lower);
  Eigen::SparseMatrix<double> joined = grid.lower;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)  // the first node and the last
      joined.coeffRef(joined.rows() - 3 + i, j) += i == j ? -0.1 : 0.0;
  joined.makeCompressed();
  check(joined);
}

TEST(FrontFactor, ReportsIndefiniteMatrices) {
  Grid grid(5);
  grid.lower.coeffRef(30, 30) = -1.0;
  FrontFactor factor;
  EXPECT_FALSE(factor.compute(grid.lower, grid.places));
  EXPECT_FALSE(factor.is_sound());
}

}  // namespace
}  // namespace fascia::sim
