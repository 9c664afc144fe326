#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <memory>
#include <vector>

#include "sim/realtime/dissection.h"
#include "sim/vector.h"

namespace fascia::sim {

/// The Cholesky factor of a symmetric positive definite matrix over nodes in space, three rows per node, in
/// single precision: multifrontal in the order of a nested dissection (Duff & Reid 1983, "The multifrontal
/// solution of indefinite sparse symmetric linear equations"; Liu 1992), every front a dense block.
///
/// It may be computed incrementally, some fronts at a time, to distribute the cost over several frames.
class FrontFactor {
 public:
  using Dense = Eigen::MatrixXf;
  using Matrix = Eigen::SparseMatrix<double>;  ///< lower half in whole blocks of three rows and columns

  /// Sets the matrix over the nodes `places`; the ordering is reused if the pattern is unchanged. Then call
  /// `advance` until it returns true.
  void begin(const Matrix& matrix, const Positions& places);
  /// Computes the ordering if necessary, or factors fronts for about `work` multiplications; true when
  /// complete.
  bool advance(double work);
  /// All at once.
  bool compute(const Matrix& matrix, const Positions& places);
  /// Discards the factor.
  void forget() { is_sound_ = false; }
  /// True if the factor is complete; false before, and if the matrix is not positive definite.
  bool is_sound() const { return is_sound_; }

  /// The solution for each column of `right` (3 x #nodes rows).
  Dense solve(const Dense& right) const;
  /// The two halves of `solve`, for a matrix A = L L': `forward` returns the transpose of L^-1 `right`, one
  /// row per column, with columns in the factor's order; `backward` takes that and returns the solutions.
  /// Columns of `right` with the same few non-zero nodes are cheaper if they are adjacent.
  Dense forward(const Dense& right) const;
  Dense backward(const Dense& halfway) const;

  size_t entries() const { return values_.size(); }  ///< of the factor
  double work() const { return work_; }              ///< multiplications of a whole factor, about

 private:
  using Panel = Eigen::Map<const Dense>;
  struct Front {
    Eigen::Index width = 0, below = 0;  ///< rows of the front, three a node
    size_t values = 0;                  ///< of its panel, (width + below) x width
    std::vector<uint32_t> children;
    double work = 0.0;
  };
  void prepare();
  void analyse(const Matrix& matrix, const Positions& places);
  bool factor_front(size_t index);
  Eigen::Index most_below() const;
  Panel panel_of(size_t front) const;
  void go_forward(Dense& x) const;
  void go_backward(Dense& x) const;

  std::unique_ptr<const realtime::Dissection> dissection_;
  std::vector<int> outer_, inner_;  ///< the pattern it was made for
  std::vector<Front> fronts_;
  std::vector<uint32_t> position_, local_;  ///< by node, by place in the order
  std::vector<float> values_;
  std::vector<Dense> left_;  ///< update matrix of each front for its parent
  Matrix matrix_;            ///< both halves once prepared
  size_t next_ = 0;
  double work_ = 0.0;
  Positions places_;
  bool is_prepared_ = false;  ///< the order is that of the matrix
  bool is_sound_ = false;
};

}  // namespace fascia::sim
