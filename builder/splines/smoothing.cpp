#include "builder/splines/smoothing.h"

#include <Eigen/Eigenvalues>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <string>

#include "builder/splines/rows.h"
#include "geometry/error.h"

namespace fascia::splines {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// Rows scaled by 1/sqrt(ridge at lambda 1): then the system is [D K D + lambda I, D P], and with Z
// orthonormal to D P and Z^T D K D Z = V diag(d) V^T the residual is V diag(lambda / (d + lambda)) V^T Z^T D
// y.
SmoothingPath::SmoothingPath(const Sites& sites, const MatrixXd& data, const SplineOptions& options) {
  SplineOptions unit = options;
  unit.lambda = 1;
  const System system = make_system(sites, unit);
  if (!system.definite)
    throw Error("spline: cross-validation needs the kernel's own null space; use degree -1");
  std::vector<Row> rows = make_rows(system, sites);
  const MatrixXd local = local_data(rows, data);
  VectorXd scale(static_cast<Index>(rows.size()));
  for (size_t i = 0; i < rows.size(); ++i) {
    if (!(rows[i].ridge > 0)) throw Error("spline: cross-validation needs finite weights");
    scale[static_cast<Index>(i)] = 1 / std::sqrt(rows[i].ridge);
    rows[i].ridge = 0;
  }
  rows_ = static_cast<int>(rows.size());
  data_scale_ = system.energy_scale();
  const Eigen::ColPivHouseholderQR<MatrixXd> qr(scale.asDiagonal() * system.polynomial_matrix(rows));
  const Index rank = qr.rank(), free = rows_ - rank;
  if (free < 1)
    throw Error("spline: cross-validation needs more than the " + std::to_string(rank) +
                " data that fix the polynomial part");
  MatrixXd form = system.kernel_matrix(rows).selfadjointView<Eigen::Lower>();
  form = scale.asDiagonal() * form * scale.asDiagonal();
  const auto Q = qr.householderQ();
  form.applyOnTheLeft(Q.adjoint());
  form.applyOnTheRight(Q);
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(form.bottomRightCorner(free, free));
  eigenvalues_ = eigen.eigenvalues().cwiseMax(0.0);
  const MatrixXd turned = Q.adjoint() * (scale.asDiagonal() * local);
  squares_ = (eigen.eigenvectors().transpose() * turned.bottomRows(free)).rowwise().squaredNorm();
}

CrossValidation SmoothingPath::at(double lambda) const {
  const Eigen::ArrayXd left = lambda / (eigenvalues_.array() + lambda);
  const double residual = (left.square() * squares_.array()).sum() * data_scale_, trace = left.sum();
  CrossValidation out;
  out.lambda = lambda;
  out.score = rows_ * residual / (trace * trace);
  out.degrees_of_freedom = rows_ - trace;
  out.variance = residual / trace;
  return out;
}

CrossValidation SmoothingPath::best() const {
  const double largest = std::max(eigenvalues_.maxCoeff(), 1e-300);
  const double low = std::log(largest) - 12 * std::log(10.0), high = std::log(largest) + 3 * std::log(10.0);
  constexpr int steps = 90;
  const double width = (high - low) / steps;
  int at_least = 0;
  double least = at(std::exp(low)).score;
  for (int k = 1; k <= steps; ++k) {
    const double score = at(std::exp(low + k * width)).score;
    if (score >= least) continue;
    least = score;
    at_least = k;
  }
  double a = low + std::max(0, at_least - 1) * width, b = low + std::min(steps, at_least + 1) * width;
  constexpr double golden = 0.6180339887498949;
  while (b - a > 1e-7) {
    const double p = b - golden * (b - a), q = a + golden * (b - a);
    if (at(std::exp(p)).score < at(std::exp(q)).score)
      b = q;
    else
      a = p;
  }
  CrossValidation out = at(std::exp(0.5 * (a + b)));
  out.at_bound = at_least == 0 || at_least == steps;
  return out;
}

CrossValidation choose_lambda(const Sites& sites, const MatrixXd& data, const SplineOptions& options) {
  return SmoothingPath(sites, data, options).best();
}

}  // namespace fascia::splines
