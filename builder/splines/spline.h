#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

#include "builder/splines/kernel.h"
#include "geometry/mesh.h"

namespace fascia::splines {

/// Coefficients of a fitted spline in coordinates q = (x - centre) * scale:
///   f_k(q) = sum_i c_ik phi(|q - q_i|) - sum_i b_ik . grad phi(q - q_i) + sum_j a_jk monomial_j(q).
/// Arrays run over centres, padded with zero coefficients to a multiple of 8; output k starts at k * stride.
struct SplineCoefficients {
  Kernel kernel{1};
  int dimension = 3;
  int outputs = 0;
  int degree = 1;
  int centres = 0;
  int stride = 0;
  Vec3 centre = Vec3::Zero();
  double scale = 1;
  std::vector<double> x, y, z;                ///< centres, `stride` each
  std::vector<double> c;                      ///< kernel coefficients, outputs * stride
  std::vector<double> bx, by, bz;             ///< gradient coefficients, outputs * stride or empty
  Eigen::MatrixXd polynomial;                 ///< monomials by outputs
  std::vector<std::array<int, 3>> monomials;  ///< exponents of each monomial
  double energy = 0;                          ///< c^T K c summed over outputs, in user units

  /// `point` in the centred, scaled coordinates of the centres; z is 0 in the plane.
  Vec3 to_local(const Vec3& point) const {
    Vec3 q = (point - centre) * scale;
    if (dimension == 2) q.z() = 0;
    return q;
  }
};

/// A fitted function from the plane (dimension 2, z ignored) or space (dimension 3) to `outputs()` numbers.
/// Immutable and cheap to copy; every const member may be called from many threads.
class Spline {
 public:
  Spline() = default;
  explicit Spline(SplineCoefficients coefficients);

  int dimension() const { return data_->dimension; }
  int outputs() const { return data_->outputs; }
  const SplineCoefficients& coefficients() const { return *data_; }

  /// Value of every output at `point`.
  Eigen::VectorXd value(const Vec3& point) const;

  /// Jacobian at `point`, outputs by 3 (the last column is 0 in 2D). At a centre of an exponent <= 1
  /// the kernel's own term, which has no gradient there, counts as 0.
  Eigen::MatrixXd jacobian(const Vec3& point) const;

  /// Hessian of output `output` at `point`, 3 by 3. Finite everywhere for exponent > 2 (values) or > 3
  /// (gradients).
  Mat3 hessian(const Vec3& point, int output = 0) const;

  /// Values of all outputs into `values` (outputs()) without allocation.
  void evaluate(const Vec3& point, double* values) const;

  /// First output and its gradient at `point`, without allocation.
  double value_and_gradient(const Vec3& point, Vec3& gradient) const;

  /// The same on the machine's vector unit, several times faster: the evaluator for implicit surfaces. The
  /// last digits depend on the unit.
  double fast_value_and_gradient(const Vec3& point, Vec3& gradient) const;

  /// First output alone, without allocation.
  double scalar(const Vec3& point) const;

  /// Values at many points: points.size() by outputs(). Vectorised over points.
  Eigen::MatrixXd values(std::span<const Vec3> points) const;

  /// Duchon's seminorm squared, summed over outputs: the bending energy of thin plates.
  double seminorm_squared() const;

 private:
  std::shared_ptr<const SplineCoefficients> data_;
};

/// Exponents of the monomials of degree at most `degree` in `dimension` variables, constant first.
std::vector<std::array<int, 3>> monomials(int dimension, int degree);

/// Value of a monomial at `q`.
double monomial_value(const std::array<int, 3>& exponents, const Vec3& q);

/// Gradient of a monomial at `q`.
Vec3 monomial_gradient(const std::array<int, 3>& exponents, const Vec3& q);

}  // namespace fascia::splines
