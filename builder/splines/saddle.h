#pragma once

// The linear algebra of splines: saddle systems [K P; P^T 0] with K definite on the null space of P^T.
//
// This work is based on:
// M. Benzi, G. Golub, J. Liesen. Numerical solution of saddle point problems, section 6. 2005

#include <Eigen/Core>
#include <Eigen/LU>

namespace fascia::splines {

/// Factors [K P; P^T 0] once and solves it for any right-hand sides.
///
/// The matrix is indefinite. P is reduced by Householder QR with column pivoting; on the null space Z of P^T
/// the form Z^T K Z is positive definite and gets a Cholesky factor, half the work of a general LU.
/// When P lacks rank, of all solutions the one with the shortest polynomial part is taken.
class SaddleSolver {
 public:
  /// `kernel`: n by n, lower triangle used. `polynomial`: n by m. `definite` false: K is not definite on the
  /// null space, so the whole matrix is factored by LU. Returns false when it is numerically singular.
  bool compute(Eigen::MatrixXd kernel, const Eigen::MatrixXd& polynomial, bool definite);

  /// Solves [K P; P^T 0] [c; a] = [top; bottom]; `bottom` with 0 rows means zeros.
  void solve(const Eigen::MatrixXd& top, const Eigen::MatrixXd& bottom, Eigen::MatrixXd& c,
             Eigen::MatrixXd& a) const;

  /// The upper left n by n block of the inverse: Bookstein's bending-energy matrix.
  Eigen::MatrixXd inverse_block() const;

  /// Rank of P.
  int rank() const { return rank_; }

 private:
  void reduce(const Eigen::MatrixXd& polynomial);
  /// Q x and Q^T x for the orthogonal factor Q = I - V T V^T of P.
  Eigen::MatrixXd turn(const Eigen::MatrixXd& x) const;
  Eigen::MatrixXd turn_back(const Eigen::MatrixXd& x) const;
  Eigen::MatrixXd determined(const Eigen::MatrixXd& x) const;

  int rows_ = 0, rank_ = 0;
  bool definite_ = true;
  Eigen::MatrixXd reflectors_, triangle_;  // V and T
  Eigen::MatrixXd upper_;                  // R, rank by m, columns in P's own order
  Eigen::MatrixXd reduced_;  // lower triangle of Q^T K Q, its last block overwritten by its Cholesky factor
  Eigen::MatrixXd square_inverse_;  // (R R^T)^-1
  Eigen::PartialPivLU<Eigen::MatrixXd> whole_;
};

}  // namespace fascia::splines
