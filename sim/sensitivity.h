#pragma once

#include <Eigen/Cholesky>
#include <memory>
#include <vector>

#include "sim/curvature.h"
#include "sim/face_model.h"
#include "sim/front_factor.h"

namespace fascia::sim {

/// How a static pose answers small changes of what drives it: the derivatives of the equilibrium
/// gradient(x, activations) = 0, from one factorisation of the curvature where the pose stands (Nocedal &
/// Wright 2006, section 10.1; Sifakis, Neverov & Fedkiw 2005 for faces).
///
/// `columns` and `jaw_columns` use the positive semidefinite stand-in of the Hessian, as Gauss-Newton steps
/// want it; `adjoint` corrects for the rest of the Hessian and is exact but for contact, whose normals are
/// held still.
class Sensitivity {
 public:
  /// `model` must be valid and outlive this.
  explicit Sensitivity(const FaceModel& model);

  /// Linearises at the pose `x` (#nodes, metres), which `controls` must have made. Returns false when the
  /// curvature has no factor; nothing else may then be asked. With `keeps_factor` the last factor serves
  /// again: `adjoint` stays exact and takes more iterations, columns are those of where the factor was made.
  bool linearise(const Controls& controls, std::span<const Vec3> x, bool keeps_factor = false);

  /// The same in parts, for a frame of a live program to bear one of them: `begin` takes the pose and what
  /// drives it, each `advance` does one thing (the matrix, or about `work` multiplications of its factor) and
  /// is true when nothing is left to do; `is_sound` then says whether there is a factor. `factor_work` is
  /// that of a whole factor.
  void begin(const Controls& controls, std::span<const Vec3> x);
  bool advance(double work);
  bool is_sound() const { return factor_.is_sound(); }
  double factor_work() const { return factor_.work(); }

  /// d position / d activation, metres: 3 x #nodes rows, one column for each of `channels`; zero where
  /// prescribed.
  Eigen::MatrixXd columns(std::span<const uint32_t> channels) const;
  /// The same for the jaw's open, forward and lateral: three columns, prescribed nodes among the rows. A
  /// motion with no room within the joint's limits gives zeros.
  Eigen::MatrixXd jaw_columns() const;

  /// The derivatives of a loss whose slope by position is `slope` (3 x #nodes, per metre): by the activations
  /// of `channels`, then by the jaw's three values.
  Eigen::VectorXd adjoint(const Eigen::VectorXd& slope, std::span<const uint32_t> channels) const;

  /// True when anything in the model listens to the channel beside the jaw and the eyes.
  bool listens(uint32_t channel) const;

 private:
  struct Force {
    uint32_t node;
    Vec3 slope;  ///< d gradient / d activation, newton
  };
  void find_slopes(const Controls& controls, std::span<const Vec3> x);
  void find_forces(const Controls& controls);
  void find_jaw_forces(const Controls& controls);
  void assemble(double held);
  void gather_pulls();
  bool solve_pulls(double work);
  Eigen::MatrixXd solve(const Eigen::MatrixXd& right) const;  ///< over unknowns
  Eigen::VectorXd hessian_times(const Eigen::VectorXd& direction) const;

  const FaceModel* model_;
  Frame frame_;
  Positions pose_;
  std::vector<int32_t> unknown_of_node_;
  Curvature curvature_;
  std::vector<std::vector<Force>> forces_;  ///< by channel
  Eigen::MatrixXd jaw_forces_;              ///< unknowns x 3
  Eigen::MatrixXd jaw_carried_;             ///< 3 #nodes x 3: how prescribed nodes go with the jaw
  FrontFactor factor_;
  std::vector<Eigen::Triplet<double>> entries_;  ///< of the matrix; kept for its memory
  bool is_assembled_ = false;
  bool is_held_up_ = false;   ///< the last matrix has had more of the rest stiffness than it wants
  Positions unknown_places_;  ///< at rest
  // Fibres' pulls, which couple all nodes along them, are kept out of the factor and brought back by the
  // identity of Sherman, Morrison and Woodbury; half of each solve is enough for that.
  Eigen::SparseMatrix<double> pulls_;
  FrontFactor::Dense halfway_pulls_;  ///< FrontFactor::forward of those that count, from the first row on
  Eigen::Index pulls_done_ = 0, pulls_kept_ = 0;
  Eigen::LLT<FrontFactor::Dense> pull_factor_;
  mutable Positions work_, direction_, product_;
};

}  // namespace fascia::sim
