#include "sim/rest_factor.h"

#include <Eigen/SparseCholesky>

namespace fascia::sim {

bool RestFactor::compute(const Eigen::SparseMatrix<double>& matrix) {
  Eigen::SimplicialLLT<Eigen::SparseMatrix<double>, Eigen::Lower> cholesky(matrix);
  if (cholesky.info() != Eigen::Success) return false;
  const Eigen::SparseMatrix<double> lower = cholesky.matrixL();
  const auto size = static_cast<size_t>(matrix.rows());
  order_.resize(size);
  const auto& inverse = cholesky.permutationPinv().indices();
  for (size_t k = 0; k < size; ++k) {
    // Eigen leaves the permutation empty when there is nothing to order.
    order_[k] =
        inverse.size() == 0 ? static_cast<uint32_t>(k) : static_cast<uint32_t>(inverse[static_cast<int>(k)]);
  }
  columns_.assign(1, 0);
  rows_.clear();
  values_.clear();
  inverse_diagonal_.clear();
  for (int column = 0; column < lower.outerSize(); ++column) {
    for (Eigen::SparseMatrix<double>::InnerIterator entry(lower, column); entry; ++entry) {
      if (entry.row() == column) {
        inverse_diagonal_.push_back(1.0 / entry.value());
      } else {
        rows_.push_back(static_cast<uint32_t>(entry.row()));
        values_.push_back(static_cast<float>(entry.value()));
      }
    }
    columns_.push_back(static_cast<uint32_t>(rows_.size()));
  }
  return true;
}

void RestFactor::solve(std::span<Vec3> values, std::span<Vec3> scratch) const {
  const size_t size = order_.size();
  for (size_t k = 0; k < size; ++k)
    scratch[k] = values[order_[k]];
  for (size_t k = 0; k < size; ++k) {
    const Vec3 value = scratch[k] * inverse_diagonal_[k];
    scratch[k] = value;
    for (uint32_t e = columns_[k]; e < columns_[k + 1]; ++e)
      scratch[rows_[e]] -= static_cast<double>(values_[e]) * value;
  }
  for (size_t k = size; k-- > 0;) {
    Vec3 value = scratch[k];
    for (uint32_t e = columns_[k]; e < columns_[k + 1]; ++e)
      value -= static_cast<double>(values_[e]) * scratch[rows_[e]];
    scratch[k] = value * inverse_diagonal_[k];
  }
  for (size_t k = 0; k < size; ++k)
    values[order_[k]] = scratch[k];
}

}  // namespace fascia::sim
