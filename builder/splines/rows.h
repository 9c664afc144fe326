#pragma once

#include <Eigen/Core>
#include <array>
#include <span>
#include <vector>

#include "builder/splines/kernel.h"
#include "builder/splines/polyharmonic.h"
#include "geometry/mesh.h"

namespace fascia::splines {

/// One datum's row of the saddle system, in the local frame q = (x - centre) * scale.
struct Row {
  Vec3 point = Vec3::Zero();
  Vec3 direction = Vec3::Zero();  ///< of a derivative, per user unit; zero for values
  bool derivative = false;
  double data_scale = 1;  ///< local datum = data_scale * the user's
  double ridge = 0;       ///< local lambda / weight, added to the diagonal
};

/// What all rows of a system share.
struct System {
  SplineOptions options;
  Kernel kernel{1};
  bool definite = true;  ///< the null space is large enough for the kernel
  std::vector<std::array<int, 3>> monomials;
  Vec3 centre = Vec3::Zero();
  double scale = 1;

  Row value_row(const Vec3& point, double weight) const;
  Row derivative_row(const Vec3& point, const Vec3& direction, double weight) const;
  double entry(const Row& a, const Row& b) const;
  Eigen::VectorXd polynomial_row(const Row& row) const;

  /// Lower triangle of K + ridge.
  Eigen::MatrixXd kernel_matrix(std::span<const Row> rows) const;
  Eigen::MatrixXd polynomial_matrix(std::span<const Row> rows) const;

  /// Factor from local to user units of c^T K c.
  double energy_scale() const;
};

/// Options resolved and the local frame laid around `sites`. Throws Error for what cannot be solved.
System make_system(const Sites& sites, const SplineOptions& options);

/// Rows of `sites`, values first. Throws Error for duplicates.
std::vector<Row> make_rows(const System& system, const Sites& sites);

/// Throws Error when two rows without ridge say something about the same thing at the same point.
void check_duplicates(std::span<const Row> rows, int dimension);

/// The spline with kernel coefficients `c` (a row a datum) and polynomial `a` that was fitted to
/// `local_data`.
Spline make_spline(const System& system, std::span<const Row> rows, const Eigen::MatrixXd& local_data,
                   const Eigen::MatrixXd& c, const Eigen::MatrixXd& a);

/// `data` in local units, checked. Throws Error for a wrong count or values that are not finite.
Eigen::MatrixXd local_data(std::span<const Row> rows, const Eigen::MatrixXd& data);

/// The message for a system that came out singular; names the two sites nearest to each other.
[[noreturn]] void throw_singular(const System& system, std::span<const Row> rows);

}  // namespace fascia::splines
