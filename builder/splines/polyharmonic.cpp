#include "builder/splines/polyharmonic.h"

#include <cmath>
#include <string>

#include "builder/splines/rows.h"
#include "builder/splines/saddle.h"
#include "geometry/error.h"

namespace fascia::splines {

using Eigen::MatrixXd;
using Eigen::VectorXd;

struct Factorisation::State {
  System system;
  std::vector<Row> rows;
  SaddleSolver solver;
};

SplineOptions duchon_options(int dimension, int derivatives, double spectral_exponent) {
  const double half = 0.5 * dimension;
  if (derivatives < 1 || !(spectral_exponent < half) || !(derivatives + spectral_exponent > half))
    throw Error("spline: Duchon's seminorm of " + std::to_string(derivatives) +
                " derivatives with s = " + std::to_string(spectral_exponent) + " in " +
                std::to_string(dimension) + " dimensions is not one; s < d/2 < m + s must hold");
  SplineOptions options;
  options.dimension = dimension;
  options.exponent = 2 * derivatives + 2 * spectral_exponent - dimension;
  options.degree = derivatives - 1;
  return options;
}

Factorisation::Factorisation(const Sites& sites, const SplineOptions& options)
    : state_(std::make_unique<State>()) {
  State& s = *state_;
  s.system = make_system(sites, options);
  s.rows = make_rows(s.system, sites);
  if (!s.solver.compute(s.system.kernel_matrix(s.rows), s.system.polynomial_matrix(s.rows),
                        s.system.definite))
    throw_singular(s.system, s.rows);
  if (options.require_full_rank && polynomial_rank() < static_cast<int>(s.system.monomials.size()))
    throw Error("spline: the data determine only " + std::to_string(polynomial_rank()) + " of the " +
                std::to_string(s.system.monomials.size()) +
                " polynomial terms: the sites lie on a line, plane or conic; add sites off it, or allow it");
}

Factorisation::~Factorisation() = default;
Factorisation::Factorisation(Factorisation&&) noexcept = default;
Factorisation& Factorisation::operator=(Factorisation&&) noexcept = default;

int Factorisation::rows() const {
  return static_cast<int>(state_->rows.size());
}
const SplineOptions& Factorisation::options() const {
  return state_->system.options;
}
int Factorisation::polynomial_rank() const {
  return state_->solver.rank();
}

Spline Factorisation::solve(const MatrixXd& data) const {
  const State& s = *state_;
  const MatrixXd local = local_data(s.rows, data);
  MatrixXd c, a;
  s.solver.solve(local, MatrixXd(), c, a);
  return make_spline(s.system, s.rows, local, c, a);
}

MatrixXd Factorisation::coefficients(const MatrixXd& data) const {
  const State& s = *state_;
  MatrixXd c, a;
  s.solver.solve(local_data(s.rows, data), MatrixXd(), c, a);
  // K_user = scale^-exponent D K D with D = 1/data_scale.
  MatrixXd out(c.rows() + a.rows(), data.cols());
  for (Eigen::Index i = 0; i < c.rows(); ++i)
    out.row(i) = s.system.energy_scale() * s.rows[static_cast<size_t>(i)].data_scale * c.row(i);
  out.bottomRows(a.rows()) = a;
  return out;
}

MatrixXd Factorisation::bending_matrix() const {
  const State& s = *state_;
  VectorXd scale(rows());
  for (int i = 0; i < rows(); ++i)
    scale[i] = s.rows[static_cast<size_t>(i)].data_scale;
  return s.system.energy_scale() * (scale.asDiagonal() * s.solver.inverse_block() * scale.asDiagonal());
}

Spline fit(const Sites& sites, const MatrixXd& data, const SplineOptions& options) {
  return Factorisation(sites, options).solve(data);
}

}  // namespace fascia::splines
