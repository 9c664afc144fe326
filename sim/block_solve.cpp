#include "sim/block_solve.h"

#include <algorithm>

namespace fascia::sim {

namespace {

constexpr int width = 8;
using Block = Eigen::Matrix<double, Eigen::Dynamic, width, Eigen::RowMajor>;
using Lower = Eigen::SparseMatrix<double>;

/// In place, first L y = x, then D z = y, then L^T x = z; L's diagonal is one and not stored.
void solve_in_place(const Lower& lower, const Eigen::VectorXd& diagonal, Block& x) {
  for (Eigen::Index j = 0; j < lower.outerSize(); ++j) {
    const Eigen::Matrix<double, 1, width> row = x.row(j);
    for (Lower::InnerIterator it(lower, j); it; ++it)
      if (it.row() > j) x.row(it.row()) -= it.value() * row;
  }
  for (Eigen::Index j = lower.outerSize() - 1; j >= 0; --j) {
    Eigen::Matrix<double, 1, width> row = x.row(j) / diagonal[j];
    for (Lower::InnerIterator it(lower, j); it; ++it)
      if (it.row() > j) row -= it.value() * x.row(it.row());
    x.row(j) = row;
  }
}

}  // namespace

Eigen::MatrixXd block_solve(const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>& factor,
                            const Eigen::MatrixXd& right) {
  if (right.cols() == 1) return factor.solve(right);
  const auto& permutation = factor.permutationP().indices();
  const Lower& lower = factor.matrixL().nestedExpression();
  const Eigen::VectorXd diagonal = factor.vectorD();
  Eigen::MatrixXd solution(right.rows(), right.cols());
  Block block(right.rows(), width);
  for (Eigen::Index first = 0; first < right.cols(); first += width) {
    const Eigen::Index count = std::min<Eigen::Index>(width, right.cols() - first);
    block.setZero();
    for (Eigen::Index i = 0; i < right.rows(); ++i)
      block.row(permutation.size() > 0 ? permutation[i] : i).head(count) = right.row(i).segment(first, count);
    solve_in_place(lower, diagonal, block);
    for (Eigen::Index i = 0; i < right.rows(); ++i)
      solution.row(i).segment(first, count) =
          block.row(permutation.size() > 0 ? permutation[i] : i).head(count);
  }
  return solution;
}

}  // namespace fascia::sim
