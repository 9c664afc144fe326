#pragma once

// Interpolation and smoothing by polyharmonic splines of value and derivative data.
//
// This work is based on:
// G. Wahba. Spline Models for Observational Data. 1990 (smoothing, generalised cross-validation)
// K. Mardia, J. Kent, C. Goodall, J. Little. Kriging and splines with derivative information. 1996

#include <Eigen/Core>
#include <array>
#include <memory>
#include <span>
#include <vector>

#include "builder/splines/kernel.h"
#include "builder/splines/spline.h"
#include "geometry/mesh.h"

namespace fascia::splines {

/// Where data are known: values at `points`, and derivatives along `derivative_directions` at
/// `derivative_points`. In 2D the third coordinate is ignored.
///
/// Weights are optional (empty: 1 each). A datum of weight w may be missed: `lambda`/w is added to its
/// diagonal; an infinite weight interpolates. For data with a standard deviation use w = 1/SD^2.
struct Sites {
  std::vector<Vec3> points;
  std::vector<double> weights;
  std::vector<Vec3> derivative_points;
  std::vector<Vec3> derivative_directions;
  std::vector<double> derivative_weights;

  int value_count() const { return static_cast<int>(points.size()); }
  int derivative_count() const { return static_cast<int>(derivative_points.size()); }
  int rows() const { return value_count() + derivative_count(); }

  /// Adds the three (dimension 3) or two partial derivatives at `point` as rows.
  void add_gradient(const Vec3& point, int dimension = 3);

  /// Adds the derivative along `direction` at `point` as a row.
  void add_derivative(const Vec3& point, const Vec3& direction);

  /// Adds the derivatives along the two tangents(normal) at `point` as rows: with data 0 they fix the
  /// direction of a field's gradient, not its length.
  void add_tangents(const Vec3& point, const Vec3& normal);
};

/// Two unit vectors that are perpendicular to `normal` and to each other, right-handed with it. Throws Error
/// for a zero normal.
std::array<Vec3, 2> tangents(const Vec3& normal);

struct SplineOptions {
  int dimension = 3;    ///< 2 or 3
  double exponent = 1;  ///< kernel exponent; > 2 when there are derivative data
  int degree = -1;      ///< of the polynomial part; -1: at least affine, and what the kernel requires
  double lambda = 0;    ///< smoothing: min sum w_i (y_i - f(x_i))^2 + lambda c^T K c; 0 interpolates
  bool unit_directions = false;    ///< normalise derivative directions first
  bool require_full_rank = false;  ///< throw when sites on a line or plane leave polynomial terms open
};

/// The options that minimise Duchon's seminorm of all `derivatives`-th derivatives weighted by |w|^2s in the
/// frequency domain: exponent 2m + 2s - d and a polynomial part of degree m - 1, which the seminorm does not
/// see. Throws Error unless s < d/2 < m + s (Duchon 1977, theorem 4).
SplineOptions duchon_options(int dimension, int derivatives, double spectral_exponent = 0);

/// The factored system of fixed sites: one factorisation, any number of right-hand sides.
///
/// The saddle system [K + lambda/W, P; P^T, 0] is indefinite; it is reduced to the null space Z of P^T by
/// Householder QR, where Z^T (K + lambda/W) Z is positive definite, and that is factored by Cholesky.
/// Polynomial directions that the sites do not determine (points on a line or plane) get coefficient 0.
class Factorisation {
 public:
  /// Throws Error for no sites, non-finite coordinates, duplicate points without smoothing, dependent
  /// derivative directions at one point, derivative data with exponent <= 2, or weights that are not
  /// positive.
  Factorisation(const Sites& sites, const SplineOptions& options);
  ~Factorisation();
  Factorisation(Factorisation&&) noexcept;
  Factorisation& operator=(Factorisation&&) noexcept;

  int rows() const;
  const SplineOptions& options() const;

  /// The spline through `data`: rows() by outputs, values first, then derivatives (per user unit).
  Spline solve(const Eigen::MatrixXd& data) const;

  /// Coefficients alone in user units: kernel rows first, then polynomial; rows() + monomials by outputs.
  Eigen::MatrixXd coefficients(const Eigen::MatrixXd& data) const;

  /// B, rows() by rows(): y^T B y is c^T K c of the spline through y (with lambda the least penalised sum
  /// over lambda), per user units. Bookstein's bending-energy matrix up to Kernel::seminorm_factor.
  Eigen::MatrixXd bending_matrix() const;

  /// Number of polynomial terms that the sites determine.
  int polynomial_rank() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

/// Factors and solves in one call.
Spline fit(const Sites& sites, const Eigen::MatrixXd& data, const SplineOptions& options = {});

}  // namespace fascia::splines
