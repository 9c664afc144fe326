#pragma once

#include <memory>
#include <vector>

#include "sim/face_model.h"
#include "sim/pose_hessian.h"

namespace fascia::sim {

/// Sensitivity of a static pose to its inputs: implicit derivatives of the equilibrium gradient(x,
/// activations) = 0, from one factorisation of the Hessian at the pose (Nocedal & Wright 2006, section 10.1;
/// Sifakis, Neverov & Fedkiw 2005 for faces).
///
/// `columns` and `jaw_columns` use the positive semidefinite approximation of the Hessian, for Gauss-Newton
/// steps; `adjoint` is corrected for the exact Hessian, except for contact, whose normals are held fixed.
class Sensitivity {
 public:
  /// `model` must be valid and outlive this.
  explicit Sensitivity(const FaceModel& model);

  /// Linearises at the pose `x` (#nodes, metres), which must have been solved for `controls`. Returns false
  /// if the factorisation fails; no other function may then be called. With `keeps_factor` the last factor is
  /// reused: `adjoint` remains exact with more iterations, and columns are those at which the factor was
  /// computed.
  bool linearise(const Controls& controls, std::span<const Vec3> x, bool keeps_factor = false);

  /// The same incrementally, to distribute the cost over frames: `begin` takes the pose and its controls;
  /// each `advance` performs one part (assembly, or about `work` multiplications of the factorisation) and
  /// returns true when complete; `is_sound` then tells whether it succeeded. `factor_work` is the work of a
  /// complete factorisation.
  void begin(const Controls& controls, std::span<const Vec3> x);
  bool advance(double work) { return hessian_.advance(work); }
  bool is_sound() const { return hessian_.is_sound(); }
  double factor_work() const { return hessian_.factor_work(); }

  /// d position / d activation, metres: 3 x #nodes rows, one column for each of `channels`; zero for
  /// prescribed nodes.
  Eigen::MatrixXd columns(std::span<const uint32_t> channels) const;
  /// The same for the jaw's open, forward and lateral: three columns, prescribed nodes among the rows. A
  /// motion that is blocked by the joint's limits gives zeros.
  Eigen::MatrixXd jaw_columns() const;

  /// The derivatives of a loss with the gradient `slope` with respect to positions (3 x #nodes, per metre):
  /// with respect to the activations of `channels`, then to the jaw's three values.
  Eigen::VectorXd adjoint(const Eigen::VectorXd& slope, std::span<const uint32_t> channels) const;

  /// True if the channel drives anything besides the jaw and the eyes.
  bool listens(uint32_t channel) const;

 private:
  struct Force {
    uint32_t node;
    Vec3 slope;  ///< d gradient / d activation, newton
  };
  void find_slopes(const Controls& controls, std::span<const Vec3> x);
  void find_forces(const Controls& controls);
  void find_jaw_forces(const Controls& controls);
  Eigen::VectorXd solve(const Eigen::VectorXd& right) const;  ///< over unknowns
  Eigen::VectorXd hessian_times(const Eigen::VectorXd& direction) const;

  const FaceModel* model_;
  Frame frame_;
  Positions pose_;
  PoseHessian hessian_;
  std::vector<std::vector<Force>> forces_;  ///< by channel
  Eigen::MatrixXd jaw_forces_;              ///< unknowns x 3
  Eigen::MatrixXd jaw_carried_;             ///< 3 #nodes x 3: how prescribed nodes go with the jaw
  mutable Positions work_, direction_, product_;
};

}  // namespace fascia::sim
