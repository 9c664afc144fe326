#pragma once

// The choice of the smoothing parameter by generalised cross-validation.
//
// This work is based on:
// P. Craven, G. Wahba. Smoothing noisy data with spline functions. 1979

#include "builder/splines/polyharmonic.h"

namespace fascia::splines {

struct CrossValidation {
  double lambda = 0;
  double score = 0;               ///< n |W^1/2 (I - A) y|^2 / tr(I - A)^2, summed over outputs
  double degrees_of_freedom = 0;  ///< tr A
  /// What `score` estimates: the data's variance (times weight) about the fitted curve.
  double variance = 0;
  bool at_bound =
      false;  ///< the best lambda is the smallest or largest looked at: interpolate, or use a polynomial
};

/// The eigenvalues behind the smoothing splines of all lambda: O(n^3) once, then O(n) a lambda.
class SmoothingPath {
 public:
  /// Errors as of Factorisation; also for fewer data than polynomial terms, and for infinite weights.
  /// `options.lambda` is not used.
  SmoothingPath(const Sites& sites, const Eigen::MatrixXd& data, const SplineOptions& options);

  /// The criterion at one lambda > 0.
  CrossValidation at(double lambda) const;

  /// The lambda of least score, by a scan over 15 decades and golden sections.
  CrossValidation best() const;

 private:
  Eigen::VectorXd eigenvalues_;  // of the kernel's form in units of lambda, ascending
  Eigen::VectorXd squares_;      // squared data along the eigenvectors, summed over outputs
  double data_scale_ = 1;
  int rows_ = 0;
};

/// The lambda that generalised cross-validation picks, for SplineOptions::lambda.
CrossValidation choose_lambda(const Sites& sites, const Eigen::MatrixXd& data, const SplineOptions& options);

}  // namespace fascia::splines
