#include "builder/splines/saddle.h"

#include <Eigen/QR>

#include "builder/splines/simd.h"
#include "geometry/dense.h"

namespace fascia::splines {

using Eigen::Index;
using Eigen::MatrixXd;

void SaddleSolver::reduce(const MatrixXd& polynomial) {
  Eigen::ColPivHouseholderQR<MatrixXd> qr;
  qr.setThreshold(1e-10);
  qr.compute(polynomial);
  rank_ = static_cast<int>(qr.rank());
  reflectors_ = MatrixXd::Zero(rows_, rank_);
  triangle_ = MatrixXd::Zero(rank_, rank_);
  for (Index j = 0; j < rank_; ++j) {
    reflectors_(j, j) = 1;
    reflectors_.col(j).tail(rows_ - j - 1) = qr.matrixQR().col(j).tail(rows_ - j - 1);
    const double tau = qr.hCoeffs()[j];
    triangle_(j, j) = tau;
    if (j > 0)
      triangle_.col(j).head(j) = -tau * triangle_.topLeftCorner(j, j) *
                                 (reflectors_.leftCols(j).transpose() * reflectors_.col(j)).eval();
  }
  const MatrixXd pivoted = qr.matrixR().topRows(rank_).triangularView<Eigen::Upper>();
  upper_ = pivoted * qr.colsPermutation().transpose();
  const MatrixXd lower = upper_.transpose();
  square_inverse_ = MatrixXd(dense::product(upper_, lower)).inverse();
}

MatrixXd SaddleSolver::turn(const MatrixXd& x) const {
  return x -
         dense::product(reflectors_, dense::product(triangle_, dense::transposed_product(reflectors_, x)));
}

MatrixXd SaddleSolver::turn_back(const MatrixXd& x) const {
  return x - dense::product(reflectors_,
                            dense::transposed_product(triangle_, dense::transposed_product(reflectors_, x)));
}

bool SaddleSolver::compute(MatrixXd kernel, const MatrixXd& polynomial, bool definite) {
  rows_ = static_cast<int>(kernel.rows());
  definite_ = definite;
  if (!definite) {
    const Index m = polynomial.cols();
    MatrixXd all = MatrixXd::Zero(rows_ + m, rows_ + m);
    all.topLeftCorner(rows_, rows_) = kernel.selfadjointView<Eigen::Lower>();
    all.topRightCorner(rows_, m) = polynomial;
    all.bottomLeftCorner(m, rows_) = polynomial.transpose();
    whole_.compute(all);
    rank_ = static_cast<int>(m);
    return whole_.rcond() > 1e-15;
  }
  reduce(polynomial);
  // Q^T K Q = K - X V^T - V X^T with X = W - V (T^T V^T W) / 2 and W = K V T: one pass over K.
  reduced_ = std::move(kernel);
  const MatrixXd moved = reduced_.selfadjointView<Eigen::Lower>() * reflectors_;
  MatrixXd X = dense::product(moved, triangle_);
  const MatrixXd half = dense::transposed_product(triangle_, dense::transposed_product(reflectors_, X));
  dense::add_product(-0.5, reflectors_, half, X);
  MatrixXd left(rows_, 2 * rank_), right(rows_, 2 * rank_);
  left << X, reflectors_;
  right << reflectors_, X;
  const size_t count = static_cast<size_t>(rows_);
  simd::functions().rank_update(
      {reduced_.data(), count, count, left.data(), right.data(), static_cast<size_t>(2 * rank_)});
  const Index free = rows_ - rank_;
  if (free == 0) return true;
  // Eigen's own is compiled for the baseline and runs at half the speed or less.
  double* corner = reduced_.data() + rank_ + static_cast<Index>(rank_) * rows_;
  return simd::functions().cholesky({corner, static_cast<size_t>(free), count}) &&
         reduced_.diagonal().allFinite();
}

// Of all a with R a = x the shortest.
MatrixXd SaddleSolver::determined(const MatrixXd& x) const {
  return dense::transposed_product(upper_, dense::product(square_inverse_, x));
}

void SaddleSolver::solve(const MatrixXd& top, const MatrixXd& bottom, MatrixXd& c, MatrixXd& a) const {
  if (!definite_) {
    MatrixXd right = MatrixXd::Zero(rows_ + rank_, top.cols());
    right.topRows(rows_) = top;
    if (bottom.rows() > 0) right.bottomRows(rank_) = bottom;
    const MatrixXd solution = whole_.solve(right);
    c = solution.topRows(rows_);
    a = solution.bottomRows(rank_);
    return;
  }
  const Index free = rows_ - rank_;
  const auto below = reduced_.bottomLeftCorner(free, rank_);
  MatrixXd turned = turn_back(top);
  MatrixXd local = MatrixXd::Zero(rows_, top.cols());
  if (bottom.rows() > 0) {
    local.topRows(rank_) = dense::product(square_inverse_, dense::product(upper_, bottom));
    dense::add_product(-1.0, below, local.topRows(rank_), turned.bottomRows(free));
    const MatrixXd corner = reduced_.topLeftCorner(rank_, rank_).selfadjointView<Eigen::Lower>();
    dense::add_product(-1.0, corner, local.topRows(rank_), turned.topRows(rank_));
  }
  if (free > 0) {
    const auto lower = reduced_.bottomRightCorner(free, free).triangularView<Eigen::Lower>();
    MatrixXd part = turned.bottomRows(free);
    lower.solveInPlace(part);
    lower.transpose().solveInPlace(part);
    local.bottomRows(free) = part;
  }
  dense::add_transposed_product(-1.0, below, local.bottomRows(free), turned.topRows(rank_));
  a = determined(turned.topRows(rank_));
  c = turn(local);
}

MatrixXd SaddleSolver::inverse_block() const {
  if (!definite_) return whole_.inverse().topLeftCorner(rows_, rows_);
  const Index free = rows_ - rank_;
  MatrixXd basis = MatrixXd::Zero(rows_, free);
  basis.bottomRows(free).setIdentity();
  basis = turn(basis).transpose().eval();  // Z^T
  if (free > 0) reduced_.bottomRightCorner(free, free).triangularView<Eigen::Lower>().solveInPlace(basis);
  MatrixXd out = MatrixXd::Zero(rows_, rows_);
  out.selfadjointView<Eigen::Lower>().rankUpdate(basis.transpose());
  return out.selfadjointView<Eigen::Lower>();
}

}  // namespace fascia::splines
