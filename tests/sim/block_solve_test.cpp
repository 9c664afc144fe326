#include "sim/block_solve.h"

#include <gtest/gtest.h>

#include <cmath>

namespace fascia::sim {
namespace {

/// The five-point Laplacian of a square grid, made definite by a touch of the identity.
Eigen::SparseMatrix<double> grid_laplacian(int side) {
  std::vector<Eigen::Triplet<double>> entries;
  const auto at = [&](int x, int y) { return y * side + x; };
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      entries.emplace_back(at(x, y), at(x, y), 4.1);
      if (x > 0) entries.emplace_back(at(x, y), at(x - 1, y), -1.0);
      if (x + 1 < side) entries.emplace_back(at(x, y), at(x + 1, y), -1.0);
      if (y > 0) entries.emplace_back(at(x, y), at(x, y - 1), -1.0);
      if (y + 1 < side) entries.emplace_back(at(x, y), at(x, y + 1), -1.0);
    }
  Eigen::SparseMatrix<double> matrix(side * side, side * side);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

TEST(BlockSolve, GivesBackWhatTheMatrixMadeForAnyNumberOfColumns) {
  const Eigen::SparseMatrix<double> matrix = grid_laplacian(17);
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(matrix);
  for (const Eigen::Index columns : {0, 1, 7, 8, 19}) {
    Eigen::MatrixXd wanted(matrix.rows(), columns);
    for (Eigen::Index i = 0; i < wanted.size(); ++i)
      wanted.data()[i] = std::sin(1.7 * static_cast<double>(i));
    const Eigen::MatrixXd found = block_solve(factor, matrix * wanted);
    ASSERT_EQ(found.cols(), columns);
    if (columns == 0) continue;
    EXPECT_LT((found - wanted).cwiseAbs().maxCoeff(), 1e-13) << columns << " columns";
  }
}

}  // namespace
}  // namespace fascia::sim
