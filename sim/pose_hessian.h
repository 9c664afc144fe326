#pragma once

#include <Eigen/Cholesky>
#include <vector>

#include "sim/curvature.h"
#include "sim/face_model.h"
#include "sim/front_factor.h"

namespace fascia::sim {

/// The factored Hessian of a face's energy at a pose, positive semidefinite element by element (see
/// `Curvature`): for Newton steps and derivatives of the equilibrium.
///
/// Vectors are over the model's unknowns, three rows per node. It may be computed incrementally, to
/// distribute the cost over several frames.
class PoseHessian {
 public:
  using Dense = FrontFactor::Dense;

  /// `model` must be valid and outlive this.
  explicit PoseHessian(const FaceModel& model);

  /// Takes the pose `x` (#nodes, metres) under `frame`, whose contact pairs must be those of `x`; then call
  /// `advance` until it returns true.
  void begin(const Frame& frame, const Vec3* x);
  /// Performs one part (assembly, or about `work` multiplications of the factorisation); true when complete.
  bool advance(double work);
  /// All at once; false if the factorisation fails.
  bool compute(const Frame& frame, const Vec3* x);
  /// True if the factor is complete; false before, and if the factorisation failed.
  bool is_sound() const { return factor_.is_sound(); }
  double factor_work() const { return factor_.work(); }  ///< multiplications of a complete factorisation

  /// The solution for each column of `right`.
  Dense solve(const Dense& right) const;

  /// The unknown of each node, or -1.
  const std::vector<int32_t>& unknown_of_node() const { return unknown_of_node_; }

 private:
  void assemble(double regularisation);
  void gather_pulls();
  bool solve_pulls(double work);

  const FaceModel* model_;
  std::vector<int32_t> unknown_of_node_;
  Positions unknown_places_;  ///< at rest
  Curvature curvature_;
  FrontFactor factor_;
  std::vector<Eigen::Triplet<double>> entries_;  ///< of the matrix; kept for its memory
  bool is_assembled_ = false;
  bool is_regularised_ = false;  ///< the last matrix was, by the rest stiffness
  // Fibre forces, which couple all nodes along them, are excluded from the factor and included by the
  // Sherman-Morrison-Woodbury identity, for which half of each solve suffices.
  Eigen::SparseMatrix<double> pulls_;
  Dense halfway_pulls_;  ///< FrontFactor::forward of those that count, from the first row on
  Eigen::Index pulls_done_ = 0, pulls_kept_ = 0;
  Eigen::LLT<Dense> pull_factor_;
};

}  // namespace fascia::sim
