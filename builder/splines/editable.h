#pragma once

// A factored spline with editable data.
//
// This work is based on:
// P. Gill, W. Murray, M. Saunders, M. Wright. Sparse matrix methods in optimization (Schur-complement
// updates). 1984

#include <memory>

#include "builder/splines/polyharmonic.h"

namespace fascia::splines {

/// A Factorisation that follows its landmarks: to add, move or remove a datum costs one solve with the old
/// factor, O(n^2), not a new one, O(n^3). Each change borders the old system by a row; after `edit_limit`
/// rows the next change factors anew, so accuracy and cost stay bounded.
class EditableFactorisation {
 public:
  /// Errors as of Factorisation. `edit_limit` 0 picks a tenth of the rows, at least 16.
  EditableFactorisation(const Sites& sites, const SplineOptions& options, int edit_limit = 0);
  ~EditableFactorisation();
  EditableFactorisation(EditableFactorisation&&) noexcept;
  EditableFactorisation& operator=(EditableFactorisation&&) noexcept;

  /// The data as they are now; rows in this order in solve(). Changed values and derivatives keep their
  /// places, new ones go to the end of their kind, those after a removed one move up.
  const Sites& sites() const;

  /// Each throws Error for an index out of range, or for a change that would leave duplicate data.
  void add_value(const Vec3& point, double weight = 1);
  void move_value(int value, const Vec3& point);
  void remove_value(int value);
  void add_derivative(const Vec3& point, const Vec3& direction, double weight = 1);
  void remove_derivative(int derivative);

  /// The spline through `data`: sites().rows() by outputs, values first, then derivatives.
  Spline solve(const Eigen::MatrixXd& data) const;

  /// Rows by which the factored system is bordered now; 0 after factoring anew.
  int border() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace fascia::splines
