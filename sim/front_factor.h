#pragma once

#include <Eigen/Core>
#include <Eigen/SparseCore>
#include <memory>
#include <vector>

#include "sim/realtime/dissection.h"
#include "sim/vector.h"

namespace fascia::sim {

/// The Cholesky factor of a symmetric positive definite matrix over nodes in space, three rows a node, in
/// single precision: multifrontal in the order of a nested dissection (Duff & Reid 1983, "The multifrontal
/// solution of indefinite sparse symmetric linear equations"; Liu 1992), every front a dense block.
///
/// It may be made in parts, some fronts at a time, so that a frame of a live program bears a share of it.
class FrontFactor {
 public:
  using Dense = Eigen::MatrixXf;
  using Matrix = Eigen::SparseMatrix<double>;  ///< lower half in whole blocks of three rows and columns

  /// Takes the matrix over the nodes `places`; its order is kept while the pattern stays. Then `advance` must
  /// be called until it is done.
  void begin(const Matrix& matrix, const Positions& places);
  /// Finds the order where it is not known yet, or factors fronts for about `work` multiplications; true when
  /// nothing is left to do.
  bool advance(double work);
  /// All at once.
  bool compute(const Matrix& matrix, const Positions& places);
  /// From now on there is no factor.
  void forget() { is_sound_ = false; }
  /// True when the factor is whole: not begun, and not when the matrix is not positive definite.
  bool is_sound() const { return is_sound_; }

  /// The solution for each column of `right` (3 x #nodes rows).
  Dense solve(const Dense& right) const;
  /// The two halves of `solve`, of a matrix A = L L': `forward` gives the transpose of L^-1 `right`, a row
  /// for each column and its columns in the factor's own order; `backward` takes that and gives the
  /// solutions. Columns of `right` that hold the same few nodes cost less where they stand together.
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
  std::vector<Dense> left_;  ///< what each front leaves to its parent
  Matrix matrix_;            ///< both halves once prepared
  size_t next_ = 0;
  double work_ = 0.0;
  Positions places_;
  bool is_prepared_ = false;  ///< the order is that of the matrix
  bool is_sound_ = false;
};

}  // namespace fascia::sim
