#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <cstdint>
#include <vector>

#include "sim/realtime/floats.h"
#include "sim/realtime/packed.h"
#include "sim/vector.h"

namespace fascia::sim::realtime {

/// Elimination order of a symmetric matrix over nodes in space: nested dissection by planes (George 1973);
/// every separator and every leaf is a supernode with dense columns.
class Dissection {
 public:
  /// `matrix` square, full; `places` of its unknowns.
  Dissection(const Eigen::SparseMatrix<double, Eigen::RowMajor>& matrix, const Positions& places);

  /// order()[k]: the unknown eliminated k-th.
  const std::vector<uint32_t>& order() const { return order_; }
  size_t size() const { return order_.size(); }

  struct Front {
    uint32_t first = 0, width = 0;  ///< of its unknowns in the order
    std::vector<uint32_t> rows;     ///< later unknowns, in the order, ascending
    int32_t parent = -1;            ///< that receives its update matrix
  };
  const std::vector<Front>& fronts() const { return fronts_; }  ///< children before parents

 private:
  void dissect(std::vector<uint32_t>& piece, const Eigen::SparseMatrix<double, Eigen::RowMajor>& matrix,
               const Positions& places);
  void eliminate(const std::vector<uint32_t>& columns);
  void find_rows(const Eigen::SparseMatrix<double, Eigen::RowMajor>& matrix);

  std::vector<uint32_t> order_;
  std::vector<Front> fronts_;
  std::vector<uint8_t> mark_;
};

/// The Cholesky factor of a matrix in an order of elimination, front by front in whole blocks of sixteen
/// rows, stored as the upper halves of floats (computed in single precision, in double where that fails).
/// Diagonal blocks are stored as their inverses.
class PanelFactor {
 public:
  /// Factors `matrix`, which must have the pattern `dissection` was made for. Returns false, and remains
  /// empty, if the matrix is not positive definite.
  bool compute(const Dissection& dissection, const Eigen::SparseMatrix<double, Eigen::RowMajor>& matrix);
  Panels view() const { return {size_, fronts_.size(), fronts_.data(), rows_.data(), values_.data()}; }
  size_t entries() const { return values_.size(); }
  size_t columns() const { return size_; }
  size_t scratch() const { return scratch_; }  ///< floats of scratch memory for a solve

 private:
  /// In numbers of the type `Real`.
  template <class Real>
  bool factor(const Dissection& dissection, const Eigen::SparseMatrix<double, Eigen::RowMajor>& matrix);
  template <class Dense>
  void pack(const Dissection::Front& from, const Dense& matrix, std::vector<uint16_t>& values);

  size_t size_ = 0, scratch_ = 0;
  std::vector<Panels::Front> fronts_;
  std::vector<int32_t> rows_;
  Aligned<uint16_t> values_;
};

}  // namespace fascia::sim::realtime
