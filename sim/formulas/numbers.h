// The number type `N` of the formulas: a double or sixteen floats (sim/lanes/lanes.h). No library header is
// included here, and every function is always inlined, so that code compiled for a wider instruction set
// cannot be called by accident.

#pragma once

namespace fascia::sim::formulas {

#define FASCIA_INLINE inline __attribute__((always_inline))

namespace {

FASCIA_INLINE double square_root(double a) {
  return __builtin_sqrt(a);
}
/// The maximum; `b` if `a` is NaN.
FASCIA_INLINE double greater(double a, double b) {
  return a > b ? a : b;
}
/// `yes` where a < b, else `no`.
FASCIA_INLINE double where_below(double a, double b, double yes, double no) {
  return a < b ? yes : no;
}
FASCIA_INLINE bool any_below(double a, double b) {
  return a < b;
}
/// `value` as a number like `like`.
FASCIA_INLINE double like(double /*like*/, double value) {
  return value;
}
FASCIA_INLINE void sine_and_versine(double angle, double& sine, double& versine) {
  const double half = __builtin_sin(0.5 * angle);
  sine = __builtin_sin(angle);
  versine = 2.0 * half * half;
}

}  // namespace

/// A vector of three numbers.
template <class N>
struct Three {
  N x, y, z;
};
template <class N>
FASCIA_INLINE Three<N> operator+(const Three<N>& a, const Three<N>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <class N>
FASCIA_INLINE Three<N> operator-(const Three<N>& a, const Three<N>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <class N>
FASCIA_INLINE Three<N> operator-(const Three<N>& a) {
  return {-a.x, -a.y, -a.z};
}
template <class N>
FASCIA_INLINE Three<N> operator*(const N& a, const Three<N>& b) {
  return {a * b.x, a * b.y, a * b.z};
}
template <class N>
FASCIA_INLINE Three<N>& operator+=(Three<N>& a, const Three<N>& b) {
  return a = a + b;
}
template <class N>
FASCIA_INLINE Three<N>& operator-=(Three<N>& a, const Three<N>& b) {
  return a = a - b;
}
template <class N>
FASCIA_INLINE N dot(const Three<N>& a, const Three<N>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class N>
FASCIA_INLINE Three<N> cross(const Three<N>& a, const Three<N>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

template <class N>
FASCIA_INLINE N positive(const N& a) {
  return greater(a, like(a, 0.0));
}

}  // namespace fascia::sim::formulas
