#pragma once

#include <Eigen/SparseCore>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/vector.h"

namespace fascia::sim {

/// Cholesky factor of a symmetric positive definite matrix over nodes that x, y and z share.
///
/// It approximates the Hessian of the rest pose in the quasi-Newton solver (Liu, Bouaziz & Kavan 2017,
/// "Quasi-Newton methods for real-time simulation of hyperelastic materials", section 4). Computed once for a
/// face; `solve` neither allocates nor throws.
class RestFactor {
 public:
  /// Factors `matrix` (#unknowns square, lower or full). Returns false when it is not positive definite.
  bool compute(const Eigen::SparseMatrix<double>& matrix);

  /// Overwrites `values` (#unknowns) with the solution; `scratch` is as long.
  void solve(std::span<Vec3> values, std::span<Vec3> scratch) const;

  uint32_t size() const { return static_cast<uint32_t>(order_.size()); }
  size_t entries() const { return rows_.size(); }

 private:
  std::vector<uint32_t> order_;    // order_[k]: the unknown eliminated k-th
  std::vector<uint32_t> columns_;  // #unknowns + 1, into rows_ and values_; below the diagonal only
  std::vector<uint32_t> rows_;
  std::vector<float> values_;
  std::vector<double> inverse_diagonal_;
};

}  // namespace fascia::sim
