#include "builder/splines/evaluate.h"

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

}  // namespace

void evaluate_points(const SplineCoefficients& s, const Vec3* points, size_t count, double* values,
                     size_t value_stride) {
  for (size_t i = 0; i < count; ++i) {
    Vec3 q = (points[i] - s.centre) * s.scale;
    if (s.dimension == 2) q.z() = 0;
    for (int k = 0; k < s.outputs; ++k)
      values[i + k * value_stride] = kernel_sum(s, k, q) + polynomial_value(s, k, q);
  }
}

double evaluate_gradient(const SplineCoefficients& s, int output, const Vec3& q, Vec3& gradient) {
  const size_t begin = static_cast<size_t>(output) * s.stride;
  double value = 0;
  gradient.setZero();
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
  for (size_t j = 0; j < s.monomials.size(); ++j) {
    const double a = s.polynomial(static_cast<Eigen::Index>(j), output);
    value += a * monomial_value(s.monomials[j], q);
    gradient += a * monomial_gradient(s.monomials[j], q);
  }
  if (s.dimension == 2) gradient.z() = 0;
  gradient *= s.scale;
  return value;
}

}  // namespace fascia::splines
