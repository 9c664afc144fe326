#include "builder/splines/polyharmonic.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <string>

#include "geometry/error.h"

namespace fascia::splines {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

std::array<double, 3> key(const Vec3& p) {
  return {p.x(), p.y(), p.z()};
}

void check_options(const Sites& sites, const SplineOptions& options) {
  if (options.dimension != 2 && options.dimension != 3)
    throw Error("spline: dimension must be 2 or 3, not " + std::to_string(options.dimension));
  if (sites.rows() == 0) throw Error("spline: no data; give at least one value");
  if (sites.derivative_directions.size() != sites.derivative_points.size())
    throw Error("spline: " + std::to_string(sites.derivative_points.size()) + " derivative points but " +
                std::to_string(sites.derivative_directions.size()) + " directions; give them in pairs");
  if (sites.derivative_count() > 0 && options.exponent <= 2)
    throw Error("spline: derivative data need a kernel exponent above 2, not " +
                std::to_string(options.exponent) + "; use 3");
  if (!(options.lambda >= 0) || !std::isfinite(options.lambda))
    throw Error("spline: smoothing lambda must be 0 or positive and finite");
}

void check_weights(const std::vector<double>& weights, int count, const char* what) {
  if (!weights.empty() && static_cast<int>(weights.size()) != count)
    throw Error(std::string("spline: ") + std::to_string(weights.size()) + " weights for " +
                std::to_string(count) + " " + what);
  for (double weight : weights)
    if (!(weight > 0))
      throw Error(std::string("spline: weights of ") + what +
                  " must be positive (leave the datum out instead)");
}

// Two values at one point contradict each other or say the same twice: both leave the system singular.
void check_duplicates(const Sites& sites, const VectorXd& ridge) {
  std::map<std::array<double, 3>, int> seen;
  for (int i = 0; i < sites.value_count(); ++i) {
    const auto [at, fresh] = seen.emplace(key(sites.points[i]), i);
    if (!fresh && (ridge[i] <= 0 && ridge[at->second] <= 0))
      throw Error("spline: data " + std::to_string(at->second) + " and " + std::to_string(i) +
                  " are at the same point; merge them or smooth (lambda > 0)");
  }
  std::map<std::array<double, 3>, std::vector<int>> groups;
  for (int j = 0; j < sites.derivative_count(); ++j)
    if (ridge[sites.value_count() + j] <= 0) groups[key(sites.derivative_points[j])].push_back(j);
  for (const auto& [point, rows] : groups) {
    Eigen::Matrix3Xd directions(3, static_cast<Index>(rows.size()));
    for (size_t k = 0; k < rows.size(); ++k)
      directions.col(static_cast<Index>(k)) = sites.derivative_directions[rows[k]].normalized();
    Eigen::ColPivHouseholderQR<Eigen::Matrix3Xd> qr(directions);
    qr.setThreshold(1e-9);
    if (qr.rank() < directions.cols())
      throw Error("spline: " + std::to_string(rows.size()) + " derivative data at the point of datum " +
                  std::to_string(rows.front()) +
                  " have dependent directions; drop one or smooth (lambda > 0)");
  }
}

Sites cleaned(const Sites& sites, const SplineOptions& options) {
  Sites out = sites;
  const auto flatten = [&](std::vector<Vec3>& points, const char* what) {
    for (size_t i = 0; i < points.size(); ++i) {
      if (options.dimension == 2) points[i].z() = 0;
      if (!points[i].allFinite())
        throw Error(std::string("spline: ") + what + " " + std::to_string(i) + " is not finite");
    }
  };
  flatten(out.points, "point");
  flatten(out.derivative_points, "derivative point");
  flatten(out.derivative_directions, "derivative direction");
  for (size_t j = 0; j < out.derivative_directions.size(); ++j) {
    Vec3& direction = out.derivative_directions[j];
    if (!(direction.norm() > 0))
      throw Error("spline: derivative direction " + std::to_string(j) + " is zero");
    if (options.unit_directions) direction.normalize();
  }
  return out;
}

}  // namespace

void Sites::add_gradient(const Vec3& point, int dimension) {
  for (int axis = 0; axis < dimension; ++axis) {
    derivative_points.push_back(point);
    derivative_directions.push_back(Vec3::Unit(axis));
  }
}

struct Factorisation::State {
  SplineOptions options;
  Kernel kernel{1};
  std::vector<std::array<int, 3>> monomials;
  int values = 0, rows = 0, rank = 0;
  Vec3 centre = Vec3::Zero();
  double scale = 1;
  std::vector<Vec3> points;      // local, one a row
  std::vector<Vec3> directions;  // user units, derivative rows only
  VectorXd row_scale;            // 1 for values, 1/scale for derivatives: local data = row_scale * user data
  VectorXd ridge;                // local lambda / w
  MatrixXd polynomial;           // P, rows by monomials
  Eigen::ColPivHouseholderQR<MatrixXd> polynomial_qr;
  MatrixXd reduced;  // Q^T (K + ridge) Q, all of it; its corner is factored
  Eigen::LLT<MatrixXd> cholesky;
  Eigen::PartialPivLU<MatrixXd> saddle;
  bool definite = true;

  void place(const Sites& sites);
  void weigh(const Sites& sites);
  MatrixXd kernel_matrix() const;
  MatrixXd polynomial_matrix() const;
  void factor();
  void solve_local(const MatrixXd& data, MatrixXd& c, MatrixXd& a) const;
};

// Centroid at the origin, farthest site at distance about 1: the solution does not depend on it, conditioning
// does.
void Factorisation::State::place(const Sites& sites) {
  points = sites.points;
  points.insert(points.end(), sites.derivative_points.begin(), sites.derivative_points.end());
  for (const Vec3& p : points)
    centre += p / static_cast<double>(points.size());
  double radius = 0;
  for (const Vec3& p : points)
    radius = std::max(radius, (p - centre).norm());
  // Without the matching null space the solution depends on the unit: keep the user's.
  if (!definite) centre.setZero();
  scale = radius > 0 && definite ? 1 / radius : 1;
  for (Vec3& p : points)
    p = (p - centre) * scale;
  directions = sites.derivative_directions;
  row_scale = VectorXd::Ones(rows);
  row_scale.tail(rows - values).setConstant(1 / scale);
}

void Factorisation::State::weigh(const Sites& sites) {
  ridge = VectorXd::Zero(rows);
  if (options.lambda == 0) return;
  const double lambda = options.lambda * std::pow(scale, kernel.exponent());
  for (int i = 0; i < rows; ++i) {
    const std::vector<double>& weights = i < values ? sites.weights : sites.derivative_weights;
    const double weight = weights.empty() ? 1 : weights[i < values ? i : i - values];
    ridge[i] = lambda / weight * row_scale[i] * row_scale[i];
  }
}

MatrixXd Factorisation::State::kernel_matrix() const {
  MatrixXd K(rows, rows);
  for (int j = 0; j < values; ++j)
    for (int i = j; i < values; ++i)
      K(i, j) = kernel.value((points[i] - points[j]).squaredNorm());
  for (int j = 0; j < values; ++j)
    for (int i = values; i < rows; ++i) {
      const Vec3 h = points[i] - points[j];
      K(i, j) = kernel.radial(h.squaredNorm()).g * directions[i - values].dot(h);
    }
  for (int j = values; j < rows; ++j)
    for (int i = j; i < rows; ++i) {
      const Vec3 h = points[i] - points[j];
      const Vec3 &u = directions[i - values], &v = directions[j - values];
      const Radial radial = kernel.radial(h.squaredNorm());
      K(i, j) = -(radial.g * u.dot(v) + radial.s * u.dot(h) * v.dot(h));
    }
  K.diagonal() += ridge;
  K.triangularView<Eigen::StrictlyUpper>() = K.transpose();
  return K;
}

MatrixXd Factorisation::State::polynomial_matrix() const {
  MatrixXd P(rows, static_cast<Index>(monomials.size()));
  for (int i = 0; i < rows; ++i)
    for (size_t j = 0; j < monomials.size(); ++j)
      P(i, static_cast<Index>(j)) =
          i < values ? monomial_value(monomials[j], points[i])
                     : monomial_gradient(monomials[j], points[i]).dot(directions[i - values]);
  return P;
}

void Factorisation::State::factor() {
  polynomial = polynomial_matrix();
  if (!definite) {
    const Index m = polynomial.cols();
    MatrixXd full = MatrixXd::Zero(rows + m, rows + m);
    full.topLeftCorner(rows, rows) = kernel_matrix();
    full.topRightCorner(rows, m) = polynomial;
    full.bottomLeftCorner(m, rows) = polynomial.transpose();
    saddle.compute(full);
    rank = static_cast<int>(m);
    if (!(saddle.rcond() > 1e-15))
      throw Error("spline: the data do not determine a polynomial of degree " +
                  std::to_string(options.degree) + " with this kernel; use degree -1");
    return;
  }
  polynomial_qr.setThreshold(1e-10);
  polynomial_qr.compute(polynomial);
  rank = static_cast<int>(polynomial_qr.rank());
  reduced = kernel_matrix();
  // Q^T K Q by the few reflectors of P; only its lower right block must be positive definite.
  const auto Q = polynomial_qr.householderQ().setLength(rank);
  reduced.applyOnTheLeft(Q.adjoint());
  reduced.applyOnTheRight(Q);
  const int left = rows - rank;
  if (left == 0) return;
  cholesky.compute(reduced.bottomRightCorner(left, left));
  if (cholesky.info() != Eigen::Success || !reduced.allFinite())
    throw Error(
        "spline: the data are so close to each other or to contradiction that the fit is numerically "
        "singular; "
        "merge near duplicates or smooth (lambda > 0)");
}

void Factorisation::State::solve_local(const MatrixXd& data, MatrixXd& c, MatrixXd& a) const {
  if (!definite) {
    MatrixXd right = MatrixXd::Zero(rows + polynomial.cols(), data.cols());
    right.topRows(rows) = data;
    const MatrixXd solution = saddle.solve(right);
    c = solution.topRows(rows);
    a = solution.bottomRows(polynomial.cols());
    return;
  }
  const auto Q = polynomial_qr.householderQ().setLength(rank);
  const MatrixXd turned = Q.adjoint() * data;
  const int left = rows - rank;
  MatrixXd free = MatrixXd::Zero(rows, data.cols());
  if (left > 0) free.bottomRows(left) = cholesky.solve(turned.bottomRows(left));
  // R a = Q1^T (y - K c); of all solutions the shortest, so directions without data get no slope.
  const MatrixXd right = turned.topRows(rank) - reduced.topRightCorner(rank, left) * free.bottomRows(left);
  const MatrixXd R = polynomial_qr.matrixR().topRows(rank).triangularView<Eigen::Upper>();
  const MatrixXd basic = R.transpose() * (R * R.transpose()).partialPivLu().solve(right);
  a = polynomial_qr.colsPermutation() * basic;
  c = Q * free;
}

Factorisation::Factorisation(const Sites& sites, const SplineOptions& options)
    : state_(std::make_unique<State>()) {
  check_options(sites, options);
  check_weights(sites.weights, sites.value_count(), "values");
  check_weights(sites.derivative_weights, sites.derivative_count(), "derivatives");
  const Sites clean = cleaned(sites, options);
  State& s = *state_;
  s.options = options;
  s.kernel = Kernel(options.exponent);
  if (s.options.degree < 0) s.options.degree = std::max(1, s.kernel.required_degree());
  s.definite = s.options.degree >= s.kernel.required_degree();
  s.monomials = splines::monomials(options.dimension, s.options.degree);
  s.values = clean.value_count();
  s.rows = clean.rows();
  s.place(clean);
  s.weigh(clean);
  check_duplicates(clean, s.ridge);
  s.factor();
}

Factorisation::~Factorisation() = default;
Factorisation::Factorisation(Factorisation&&) noexcept = default;
Factorisation& Factorisation::operator=(Factorisation&&) noexcept = default;

int Factorisation::rows() const {
  return state_->rows;
}
const SplineOptions& Factorisation::options() const {
  return state_->options;
}
int Factorisation::polynomial_rank() const {
  return state_->rank;
}

Spline Factorisation::solve(const MatrixXd& data) const {
  const State& s = *state_;
  if (data.rows() != s.rows)
    throw Error("spline: " + std::to_string(data.rows()) + " data for " + std::to_string(s.rows) + " sites");
  if (!data.allFinite()) throw Error("spline: data contain a value that is not finite");
  MatrixXd c, a;
  const MatrixXd local = s.row_scale.asDiagonal() * data;
  s.solve_local(local, c, a);

  SplineCoefficients out;
  out.kernel = s.kernel;
  out.dimension = s.options.dimension;
  out.outputs = static_cast<int>(data.cols());
  out.degree = s.options.degree;
  out.centre = s.centre;
  out.scale = s.scale;
  out.monomials = s.monomials;
  out.polynomial = a;
  // c^T K c = c^T (y - P a) - c^T ridge c, and c is orthogonal to P.
  out.energy = ((c.array() * local.array()).sum() - (c.array().square().colwise() * s.ridge.array()).sum()) *
               std::pow(s.scale, s.kernel.exponent());

  // Rows at one place become one centre.
  std::map<std::array<double, 3>, int> places;
  std::vector<int> centre_of(static_cast<size_t>(s.rows));
  std::vector<Vec3> centres;
  for (int i = 0; i < s.rows; ++i) {
    const auto [at, fresh] = places.emplace(key(s.points[i]), static_cast<int>(centres.size()));
    if (fresh) centres.push_back(s.points[i]);
    centre_of[i] = at->second;
  }
  out.centres = static_cast<int>(centres.size());
  out.stride = (out.centres + 7) / 8 * 8;
  const size_t stride = static_cast<size_t>(out.stride), total = stride * out.outputs;
  out.x.assign(stride, 0);
  out.y.assign(stride, 0);
  out.z.assign(stride, 0);
  for (size_t i = 0; i < centres.size(); ++i) {
    out.x[i] = centres[i].x();
    out.y[i] = centres[i].y();
    out.z[i] = centres[i].z();
  }
  out.c.assign(total, 0);
  if (s.rows > s.values) {
    out.bx.assign(total, 0);
    out.by.assign(total, 0);
    out.bz.assign(total, 0);
  }
  for (int k = 0; k < out.outputs; ++k)
    for (int i = 0; i < s.rows; ++i) {
      const size_t at = k * stride + centre_of[i];
      if (i < s.values) {
        out.c[at] += c(i, k);
        continue;
      }
      const Vec3 b = c(i, k) * s.directions[i - s.values];
      out.bx[at] += b.x();
      out.by[at] += b.y();
      out.bz[at] += b.z();
    }
  return Spline(std::move(out));
}

MatrixXd Factorisation::coefficients(const MatrixXd& data) const {
  const State& s = *state_;
  MatrixXd c, a;
  s.solve_local(s.row_scale.asDiagonal() * data, c, a);
  // K_user = scale^-exponent D K D with D = 1/row_scale.
  const double power = std::pow(s.scale, s.kernel.exponent());
  MatrixXd out(s.rows + a.rows(), data.cols());
  out.topRows(s.rows) = power * (s.row_scale.asDiagonal() * c);
  out.bottomRows(a.rows()) = a;
  return out;
}

Spline fit(const Sites& sites, const MatrixXd& data, const SplineOptions& options) {
  return Factorisation(sites, options).solve(data);
}

}  // namespace fascia::splines
