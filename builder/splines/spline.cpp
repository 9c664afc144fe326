#include "builder/splines/spline.h"

#include <cmath>

#include "builder/splines/evaluate.h"

namespace fascia::splines {
namespace {

double power(double base, int exponent) {
  double out = 1;
  for (int i = 0; i < exponent; ++i)
    out *= base;
  return out;
}

// Derivative of a monomial, `order` times along each axis.
double monomial_derivative(const std::array<int, 3>& exponents, const std::array<int, 3>& order,
                           const Vec3& q) {
  double out = 1;
  for (int axis = 0; axis < 3; ++axis) {
    int left = exponents[axis];
    for (int k = 0; k < order[axis]; ++k)
      out *= left--;
    if (out == 0) return 0;
    out *= power(q[axis], left);
  }
  return out;
}

}  // namespace

std::vector<std::array<int, 3>> monomials(int dimension, int degree) {
  std::vector<std::array<int, 3>> out;
  for (int total = 0; total <= degree; ++total)
    for (int i = total; i >= 0; --i)
      for (int j = total - i; j >= 0; --j) {
        const int k = total - i - j;
        if (dimension == 3 || k == 0) out.push_back({i, j, k});
      }
  return out;
}

double monomial_value(const std::array<int, 3>& exponents, const Vec3& q) {
  return power(q.x(), exponents[0]) * power(q.y(), exponents[1]) * power(q.z(), exponents[2]);
}

Vec3 monomial_gradient(const std::array<int, 3>& exponents, const Vec3& q) {
  return {monomial_derivative(exponents, {1, 0, 0}, q), monomial_derivative(exponents, {0, 1, 0}, q),
          monomial_derivative(exponents, {0, 0, 1}, q)};
}

Spline::Spline(SplineCoefficients coefficients)
    : data_(std::make_shared<const SplineCoefficients>(std::move(coefficients))) {}

Eigen::VectorXd Spline::value(const Vec3& point) const {
  Eigen::VectorXd out(outputs());
  evaluate(point, out.data());
  return out;
}

void Spline::evaluate(const Vec3& point, double* values) const {
  const SplineCoefficients& s = *data_;
  evaluate_points(s, &point, 1, values, 1);
}

double Spline::scalar(const Vec3& point) const {
  if (outputs() == 1) {
    double value;
    evaluate(point, &value);
    return value;
  }
  Vec3 gradient;
  return value_and_gradient(point, gradient);
}

double Spline::value_and_gradient(const Vec3& point, Vec3& gradient) const {
  const SplineCoefficients& s = *data_;
  return evaluate_gradient(s, 0, s.to_local(point), gradient);
}

double Spline::fast_value_and_gradient(const Vec3& point, Vec3& gradient) const {
  const SplineCoefficients& s = *data_;
  return evaluate_gradient_in_vectors(s, 0, s.to_local(point), gradient);
}

Eigen::MatrixXd Spline::jacobian(const Vec3& point) const {
  const SplineCoefficients& s = *data_;
  Eigen::MatrixXd out(outputs(), 3);
  const Vec3 q = s.to_local(point);
  for (int k = 0; k < outputs(); ++k) {
    Vec3 gradient;
    evaluate_gradient(s, k, q, gradient);
    out.row(k) = gradient.transpose();
  }
  return out;
}

Mat3 Spline::hessian(const Vec3& point, int output) const {
  const SplineCoefficients& s = *data_;
  const Vec3 q = s.to_local(point);
  const size_t begin = static_cast<size_t>(output) * s.stride;
  Mat3 out = Mat3::Zero();
  for (int i = 0; i < s.centres; ++i) {
    const Vec3 h = q - Vec3(s.x[i], s.y[i], s.z[i]);
    const Radial radial = s.kernel.radial(h.squaredNorm());
    out += s.c[begin + i] * (radial.g * Mat3::Identity() + radial.s * h * h.transpose());
    if (s.bx.empty()) continue;
    const Vec3 b(s.bx[begin + i], s.by[begin + i], s.bz[begin + i]);
    const double along = b.dot(h);
    out -= radial.s * (along * Mat3::Identity() + b * h.transpose() + h * b.transpose()) +
           radial.t * along * h * h.transpose();
  }
  for (size_t j = 0; j < s.monomials.size(); ++j)
    for (int row = 0; row < 3; ++row)
      for (int column = 0; column < 3; ++column) {
        std::array<int, 3> order{};
        ++order[row];
        ++order[column];
        out(row, column) += s.polynomial(static_cast<Eigen::Index>(j), output) *
                            monomial_derivative(s.monomials[j], order, q);
      }
  if (s.dimension == 2) {
    out.row(2).setZero();
    out.col(2).setZero();
  }
  return out * (s.scale * s.scale);
}

Eigen::MatrixXd Spline::values(std::span<const Vec3> points) const {
  Eigen::MatrixXd out(static_cast<Eigen::Index>(points.size()), outputs());
  evaluate_points(*data_, points.data(), points.size(), out.data(), points.size());
  return out;
}

double Spline::seminorm_squared() const {
  return data_->energy * data_->kernel.seminorm_factor(data_->dimension);
}

}  // namespace fascia::splines
