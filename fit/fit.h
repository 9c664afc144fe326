#pragma once

#include <array>
#include <string>
#include <vector>

#include "fit/subject.h"
#include "fit/visibility.h"
#include "sim/sensitivity.h"

namespace fascia::fit {

/// A target: the displacement of each vertex, and its weight.
struct Target {
  Eigen::VectorXd displacements;   ///< 3 x #vertices of the subject, metres from rest
  std::vector<double> confidence;  ///< #vertices, 0 for unobserved vertices
  /// 3 x #vertices, unit, or empty. If given, the error is mainly the distance along it (point to plane, Chen
  /// & Medioni 1992): the vertex may slide over the surface it was matched to.
  Eigen::VectorXd normals = {};
};

struct FitOptions {
  /// Penalties in square millimetres of mean squared error, on squared and absolute activations. They are
  /// larger for channels that the rig's expression tables rarely use.
  double ridge = 2e-5;
  double sparsity = 2e-4;
  /// The same for squared changes from frame to frame.
  double smoothness = 2e-3;
  int iterations = 30;         ///< maximum number of Gauss-Newton steps
  std::vector<uint32_t> held;  ///< channels that are kept fixed
};

struct FitResult {
  std::vector<float> activations;  ///< one per channel of the rig
  double share = 0.0;              ///< 1 - sum |u - v|^2 / sum |v|^2 over weighted vertices
  double error_mm = 0.0;  ///< mean residual where the target moves more than 0.5 mm; otherwise over all
  double rms_mm = 0.0;    ///< root mean square residual over weighted vertices
  int iterations = 0;
  bool converged = false;
  Eigen::VectorXd
      displacements;  ///< 3 x #vertices, metres: the fitted pose, solved from rest as `pose` would
  /// By channel: change of the activation, with all others re-optimised, that raises the root mean square
  /// error by 0.05 mm (from the Hessian of the fit); 0 for channels that are not fitted; empty: not known.
  std::vector<double> spread;
  /// Pairs of active channels that the target hardly distinguishes: correlation above 0.9 in the inverse of
  /// that Hessian.
  std::vector<std::pair<uint32_t, uint32_t>> alike;
};

/// Accumulates the residual statistics of a fit.
class Misses {
 public:
  /// `left`: residual of a point; `moved`: its target displacement; metres. `confidence` above 0.
  void add(double left, double moved, double confidence = 1.0);
  double motion() const { return whole_; }  ///< weighted squares of what should have moved
  /// Writes share, error_mm and rms_mm.
  void write(FitResult& result) const;

 private:
  double left_ = 0.0, whole_ = 0.0, confidence_ = 0.0, miss_ = 0.0, miss_moved_ = 0.0;
  size_t count_ = 0, count_moved_ = 0;
};

/// The mean squared distance of a pose from a target, with derivatives with respect to activations.
struct Linearised {
  std::vector<uint32_t> channels;  ///< that rows and columns below stand for
  Eigen::MatrixXd hessian;         ///< Gauss-Newton, of half the mean squared distance, mm^2
  Eigen::VectorXd slope;           ///< of the same
  double mean_square = 0.0;        ///< mm^2, over weighted vertices
  double target_square = 0.0;      ///< of the target's own motion, mm^2
};

/// Fits the activations of a static pose to targets: Gauss-Newton on the full simulation, with contact,
/// within the channels' ranges (Sifakis, Neverov & Fedkiw 2005, "Automatic determination of facial muscle
/// activations from sparse motion capture marker data", section 4), gradients by the adjoint of the
/// equilibrium, the Jacobian corrected by what each step did.
///
/// Channels that only move the mandible, like its own three, stay at rest, so that the solution is unique;
/// eyes are fitted to their meshes, or to the lids if their meshes are not observed.
class Fitter {
 public:
  explicit Fitter(Subject& subject, const FitOptions& options = {});

  /// Throws fascia::Error when the target has no confidence in any vertex that the rig moves.
  FitResult fit(const Target& target);
  /// The next frame of a take: starts from the last result, with the smoothness penalty.
  FitResult follow(const Target& target);

  /// The pose of `values` beside `target`; costs do not count. Throws fascia::Error when the target has no
  /// confidence in any vertex that the rig moves, or the pose has no derivative.
  Linearised linearised(const Target& target, const std::vector<float>& values);

  /// Changes the penalties and the number of steps.
  void set_options(const FitOptions& options);

 private:
  FitResult solve(const Target& target, bool is_next);
  void take_weights(const Target& target, bool is_next);
  /// Half the Hessian of the weighted squared distance, square metres; `vertex_weights` by vertex.
  Eigen::MatrixXd gathered(const Eigen::VectorXd& vertex_weights) const;
  /// A price of channel `fitted_[i]`, given that of a common channel that is seen whole; and that of its
  /// change.
  double price(double of_common, size_t i) const;
  double price_of_change(size_t i) const;
  /// Half the gradient of the mean squared distance, by the adjoint or by the columns at hand.
  Eigen::VectorXd slope_of(const Eigen::VectorXd& difference, bool by_columns) const;
  /// Mean squared error plus penalties of `values`; poses the subject.
  double objective(const Target& target, const std::vector<float>& values, bool warm,
                   Eigen::VectorXd& difference);
  double cost(const std::vector<float>& values) const;
  bool linearise(const std::vector<float>& values, const sim::Positions& nodes);
  bool is_eye(uint32_t channel) const;
  /// Keeps the options' channels, and the gaze of each eye that is seen (left, right), where they are.
  void hold(const std::array<bool, 2>& eyes);
  void find_eyes(const Target& target, std::vector<float>& values);
  /// Half the Hessian of the mean squared error where vertices may slide along a surface.
  void gather_sliding();
  Vec3 weighted(Eigen::Index vertex, const Vec3& difference) const;
  Eigen::VectorXd step(const Eigen::VectorXd& slope, const std::vector<float>& values, double radius) const;
  /// Where a fit stands.
  struct Descent {
    std::vector<float> values;
    Eigen::VectorXd difference;   ///< 3 x #vertices, metres: of the pose from the target
    sim::Positions nodes;         ///< of the pose
    double value = 0.0;           ///< of the objective
    double radius = 1.0;          ///< how far a channel may go in a step
    bool needs_jacobian = false;  ///< the columns at hand mislead
    bool is_fresh = false;        ///< they were computed here
  };
  enum class Progress { falls, ends, stuck };
  Progress descend(const Target& target, bool is_next, Descent& at);
  /// Computes the Jacobian where the pose is far from where it was; false where it has none.
  bool renew_jacobian(bool is_next, Descent& at);
  Eigen::VectorXd slope_at(const Descent& at) const;
  /// Half the gradient of the mean squared distance, by the columns and what was learnt since.
  Eigen::VectorXd slope_by_columns(const Eigen::VectorXd& difference) const;
  /// The same by vertex: 3 x #vertices, mm^2 a metre.
  Eigen::VectorXd pulls(const Eigen::VectorXd& difference) const;

  /// A correction of the Jacobian: miss move^T / square.
  struct Secant {
    Eigen::VectorXd miss;  ///< 3 x #vertices, metres
    Eigen::VectorXd move;  ///< #fitted
    double square = 0.0;
  };
  /// The columns come from a semidefinite Hessian, stiffer than the tissue in compression, and steps by them
  /// alone overshoot. What a step did corrects them (Broyden 1965, "A class of methods for solving nonlinear
  /// simultaneous equations"), and so does the exact gradient, by the adjoint, where they were computed
  /// (Schlenkrich, Griewank & Walther 2010, "On the local convergence of adjoint Broyden methods").
  void learn_step(const Eigen::VectorXd& move, const Eigen::VectorXd& moved);
  void learn_gradient(const Eigen::VectorXd& difference);
  void learn(Secant secant);
  void finish(const Target& target, FitResult& result);

  Subject* subject_;
  FitOptions options_;
  sim::Sensitivity sensitivity_;
  std::vector<uint32_t> driven_;    ///< channels fitted that tissue listens to, eyes among them by their lids
  std::vector<uint32_t> fitted_;    ///< those, then the jaw's
  std::vector<bool> is_held_;       ///< by channel
  std::vector<double> dearness_;    ///< by channel: penalty relative to that of a common one
  std::vector<float> last_;         ///< the last frame's activations
  std::vector<float> linear_at_;    ///< where the columns below were taken
  Eigen::MatrixXd node_columns_;    ///< 3 #nodes x #fitted
  Eigen::MatrixXd jaw_slopes_;      ///< 3 #vertices x 3
  std::vector<Secant> secants_;     ///< since the columns were computed
  Eigen::MatrixXd hessian_;         ///< #fitted square: of the mean squared error in mm^2, halved
  Eigen::VectorXd vertex_weights_;  ///< #vertices: confidence over its sum
  double confidence_ = 0.0;         ///< sum of the target's confidences
  Visibility visibility_;
  Eigen::VectorXd slide_normals_;  ///< of the target; empty: distances count in all directions
  bool is_sequence_ = false;
};

}  // namespace fascia::fit
