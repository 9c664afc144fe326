#pragma once

// Polyharmonic and Duchon kernels.
//
// This work is based on:
// J. Duchon. Splines minimizing rotation-invariant semi-norms in Sobolev spaces. 1977
// H. Wendland. Scattered Data Approximation, ch. 8 and 16. 2004

namespace fascia::splines {

/// The four radial quantities from which a kernel and its first three derivatives are built.
/// With h = x - y, r = |h|:  gradient = g h,  Hessian = g I + s h h^T,
/// third derivative_ijk = s (d_ij h_k + d_ik h_j + d_jk h_i) + t h_i h_j h_k.
/// All are 0 at r = 0, the limit of the terms they stand in wherever these exist.
struct Radial {
  double phi = 0, g = 0, s = 0, t = 0;
};

/// A conditionally positive definite kernel phi(r) = sign r^exponent, or sign r^exponent ln r when the
/// exponent is even. The sign makes the quadratic form positive on coefficients orthogonal to the
/// polynomials of degree `required_degree`.
///
/// Duchon's seminorm of m derivatives weighted by |w|^2s in d dimensions has exponent = 2m + 2s - d:
/// 1 is the thin plate in 3D (m = 2), 2 the thin plate in 2D. Gradient data need exponent > 2,
/// Hessians need exponent > 4.
class Kernel {
 public:
  /// Throws Error unless 0 < exponent <= 9.
  explicit Kernel(double exponent);

  double exponent() const { return exponent_; }
  double sign() const { return sign_; }
  bool logarithmic() const { return logarithmic_; }

  /// Least degree of the polynomial part that makes interpolation well-posed.
  int required_degree() const { return required_degree_; }

  /// phi and its radial derivatives at squared distance `squared_radius`.
  Radial radial(double squared_radius) const;

  /// phi alone.
  double value(double squared_radius) const;

  /// Factor that turns the form c^T K c into Duchon's seminorm squared in `dimension` dimensions
  /// (8 pi for both thin plates): one over the constant of the Green's function.
  double seminorm_factor(int dimension) const;

 private:
  double exponent_ = 1;
  double sign_ = -1;
  bool logarithmic_ = false;
  int required_degree_ = 0;
};

}  // namespace fascia::splines
