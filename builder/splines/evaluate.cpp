#include "builder/splines/evaluate.h"

#include <algorithm>

#include "builder/splines/simd.h"

namespace fascia::splines {
namespace {

double polynomial_value(const SplineCoefficients& s, int output, const Vec3& q) {
  double out = 0;
  for (size_t j = 0; j < s.monomials.size(); ++j)
    out += s.polynomial(static_cast<Eigen::Index>(j), output) * monomial_value(s.monomials[j], q);
  return out;
}

double kernel_sum(const SplineCoefficients& s, int output, const Vec3& q) {
  const size_t begin = static_cast<size_t>(output) * s.stride;
  double out = 0;
  for (int i = 0; i < s.centres; ++i) {
    const Vec3 h = q - Vec3(s.x[i], s.y[i], s.z[i]);
    const double squared = h.squaredNorm();
    if (s.bx.empty()) {
      out += s.c[begin + i] * s.kernel.value(squared);
      continue;
    }
    const Radial radial = s.kernel.radial(squared);
    out += s.c[begin + i] * radial.phi -
           radial.g * (s.bx[begin + i] * h.x() + s.by[begin + i] * h.y() + s.bz[begin + i] * h.z());
  }
  return out;
}

constexpr size_t block = 256;

// values = monomials times coefficients at `size` points, a column of the block for each monomial.
void polynomial_block(const SplineCoefficients& s, const double* x, const double* y, const double* z,
                      size_t size, double* values, size_t value_stride) {
  for (int k = 0; k < s.outputs; ++k)
    std::fill_n(values + k * value_stride, size, 0.0);
  const double* coordinates[3] = {x, y, z};
  double monomial[block];
  for (size_t j = 0; j < s.monomials.size(); ++j) {
    std::fill_n(monomial, size, 1.0);
    for (int axis = 0; axis < 3; ++axis)
      for (int power = 0; power < s.monomials[j][axis]; ++power)
        for (size_t i = 0; i < size; ++i)
          monomial[i] *= coordinates[axis][i];
    for (int k = 0; k < s.outputs; ++k) {
      const double coefficient = s.polynomial(static_cast<Eigen::Index>(j), k);
      double* column = values + k * value_stride;
      for (size_t i = 0; i < size; ++i)
        column[i] += coefficient * monomial[i];
    }
  }
}

void evaluate_in_vectors(const SplineCoefficients& s, int exponent, const Vec3* points, size_t count,
                         double* values, size_t value_stride) {
  double x[block], y[block], z[block];
  for (size_t begin = 0; begin < count; begin += block) {
    const size_t size = std::min(block, count - begin);
    for (size_t i = 0; i < size; ++i) {
      const Vec3 q = s.to_local(points[begin + i]);
      x[i] = q.x();
      y[i] = q.y();
      z[i] = q.z();
    }
    polynomial_block(s, x, y, z, size, values + begin, value_stride);
    for (int first = 0; first < s.outputs; first += 4) {
      simd::Sum sum{};
      sum.x = s.x.data();
      sum.y = s.y.data();
      sum.z = s.z.data();
      sum.centres = static_cast<size_t>(s.centres);
      sum.stride = static_cast<size_t>(s.stride);
      sum.weights = s.c.data() + first * sum.stride;
      sum.outputs = std::min(4, s.outputs - first);
      sum.exponent = exponent;
      sum.sign = s.kernel.sign();
      sum.px = x;
      sum.py = y;
      sum.pz = z;
      sum.points = size;
      sum.values = values + begin + first * value_stride;
      sum.value_stride = value_stride;
      simd::functions().sum(sum);
    }
  }
}

}  // namespace

int simd_exponent(const Kernel& kernel) {
  for (int exponent : {1, 3, 5})
    if (kernel.exponent() == exponent) return exponent;
  return 0;
}

void evaluate_points(const SplineCoefficients& s, const Vec3* points, size_t count, double* values,
                     size_t value_stride) {
  const int exponent = simd_exponent(s.kernel);
  if (exponent > 0 && s.bx.empty()) {
    evaluate_in_vectors(s, exponent, points, count, values, value_stride);
    return;
  }
  for (size_t i = 0; i < count; ++i) {
    const Vec3 q = s.to_local(points[i]);
    for (int k = 0; k < s.outputs; ++k)
      values[i + k * value_stride] = kernel_sum(s, k, q) + polynomial_value(s, k, q);
  }
}

namespace {

double kernel_gradient(const SplineCoefficients& s, int output, const Vec3& q, Vec3& gradient) {
  const size_t begin = static_cast<size_t>(output) * s.stride;
  double value = 0;
  for (int i = 0; i < s.centres; ++i) {
    const Vec3 h = q - Vec3(s.x[i], s.y[i], s.z[i]);
    const Radial radial = s.kernel.radial(h.squaredNorm());
    value += s.c[begin + i] * radial.phi;
    gradient += s.c[begin + i] * radial.g * h;
    if (s.bx.empty()) continue;
    const Vec3 b(s.bx[begin + i], s.by[begin + i], s.bz[begin + i]);
    const double along = b.dot(h);
    value -= radial.g * along;
    gradient -= radial.g * b + radial.s * along * h;
  }
  return value;
}

double kernel_gradient_in_vectors(const SplineCoefficients& s, int exponent, int output, const Vec3& q,
                                  Vec3& gradient) {
  const size_t begin = static_cast<size_t>(output) * s.stride;
  const auto dipoles = [&](const std::vector<double>& b) { return b.empty() ? nullptr : b.data() + begin; };
  double out[4];
  simd::functions().gradient_sum({s.x.data(), s.y.data(), s.z.data(), static_cast<size_t>(s.stride),
                                  s.c.data() + begin, dipoles(s.bx), dipoles(s.by), dipoles(s.bz), exponent,
                                  s.kernel.sign(), q.x(), q.y(), q.z(), out});
  gradient = Vec3(out[1], out[2], out[3]);
  return out[0];
}

// Adds the polynomial part, and turns the gradient to user units.
double add_polynomial(const SplineCoefficients& s, int output, const Vec3& q, double value, Vec3& gradient) {
  for (size_t j = 0; j < s.monomials.size(); ++j) {
    const double a = s.polynomial(static_cast<Eigen::Index>(j), output);
    value += a * monomial_value(s.monomials[j], q);
    gradient += a * monomial_gradient(s.monomials[j], q);
  }
  if (s.dimension == 2) gradient.z() = 0;
  gradient *= s.scale;
  return value;
}

}  // namespace

double evaluate_gradient(const SplineCoefficients& s, int output, const Vec3& q, Vec3& gradient) {
  gradient.setZero();
  const double value = kernel_gradient(s, output, q, gradient);
  return add_polynomial(s, output, q, value, gradient);
}

double evaluate_gradient_in_vectors(const SplineCoefficients& s, int output, const Vec3& q, Vec3& gradient) {
  const int exponent = simd_exponent(s.kernel);
  if (exponent == 0) return evaluate_gradient(s, output, q, gradient);
  const double value = kernel_gradient_in_vectors(s, exponent, output, q, gradient);
  return add_polynomial(s, output, q, value, gradient);
}

}  // namespace fascia::splines
