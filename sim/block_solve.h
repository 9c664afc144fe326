#pragma once

#include <Eigen/SparseCholesky>

namespace fascia::sim {

/// The solution of A X = `right` by the factor of A, for many columns (#rows of A x any number). The factor
/// is walked once for eight columns, which lie side by side in memory, where Eigen's own solve walks it for
/// each: what a factor larger than the caches costs is reading it. The same numbers as Eigen's but for
/// rounding.
Eigen::MatrixXd block_solve(const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>>& factor,
                            const Eigen::MatrixXd& right);

}  // namespace fascia::sim
