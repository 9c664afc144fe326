#include "builder/splines/kernel.h"

#include <cmath>
#include <numbers>
#include <string>

#include "geometry/error.h"

namespace fascia::splines {

Kernel::Kernel(double exponent) : exponent_(exponent) {
  if (!(exponent > 0 && exponent <= 9))
    throw Error("spline kernel: exponent " + std::to_string(exponent) +
                " is outside (0, 9]; use 1 or 2 for values, 3 or more with gradients");
  logarithmic_ = std::fmod(exponent, 2.0) == 0.0;
  const int half = static_cast<int>(std::ceil(exponent / 2));
  const int order = logarithmic_ ? half + 1 : half;
  sign_ = order % 2 == 0 ? 1.0 : -1.0;
  required_degree_ = order - 1;
}

Radial Kernel::radial(double squared_radius) const {
  if (squared_radius <= 0) return {};
  const double r = std::sqrt(squared_radius);
  Radial out;
  if (!logarithmic_) {
    const double beta = exponent_;
    const double power = exponent_ == 1   ? r
                         : exponent_ == 3 ? r * squared_radius
                         : exponent_ == 5 ? r * squared_radius * squared_radius
                                          : std::pow(r, beta);
    const double inverse = 1 / squared_radius;
    out.phi = sign_ * power;
    out.g = beta * out.phi * inverse;
    out.s = (beta - 2) * out.g * inverse;
    out.t = (beta - 4) * out.s * inverse;
    return out;
  }
  // Each derivative over r maps r^p (a ln r + b) to r^(p-2) (p a ln r + p b + a).
  const double logarithm = std::log(r);
  const double inverse = 1 / squared_radius;
  double power = exponent_, a = sign_, b = 0, factor = std::pow(r, exponent_);
  const auto descend = [&] {
    b = power * b + a;
    a *= power;
    power -= 2;
    factor *= inverse;
    return factor * (a * logarithm + b);
  };
  out.phi = factor * a * logarithm;
  out.g = descend();
  out.s = descend();
  out.t = descend();
  return out;
}

double Kernel::value(double squared_radius) const {
  if (squared_radius <= 0) return 0;
  if (exponent_ == 1) return sign_ * std::sqrt(squared_radius);
  if (exponent_ == 3) return sign_ * squared_radius * std::sqrt(squared_radius);
  const double power = std::pow(squared_radius, 0.5 * exponent_);
  return logarithmic_ ? sign_ * power * 0.5 * std::log(squared_radius) : sign_ * power;
}

double Kernel::seminorm_factor(int dimension) const {
  const double order = 0.5 * (exponent_ + dimension);
  const double common = std::pow(std::numbers::pi, 0.5 * dimension) * std::tgamma(order);
  if (logarithmic_) return std::pow(2.0, 2 * order - 1) * common * std::tgamma(order - 0.5 * dimension + 1);
  return std::abs(std::pow(4.0, order) * common / std::tgamma(0.5 * dimension - order));
}

}  // namespace fascia::splines
