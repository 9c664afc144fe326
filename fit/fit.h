#pragma once

#include <array>
#include <string>
#include <vector>

#include "fit/subject.h"
#include "sim/sensitivity.h"

namespace fascia::fit {

/// What a face should look like: where each vertex should go, and how much it is to be weighted.
struct Target {
  Eigen::VectorXd displacements;   ///< 3 x #vertices of the subject, metres from rest
  std::vector<double> confidence;  ///< #vertices, 0 where nothing is known of a vertex
  /// 3 x #vertices, unit, or empty. Where given, only the distance along it counts (and a little the rest):
  /// the vertex may slide over a surface it was matched to (Chen & Medioni 1992).
  Eigen::VectorXd normals = {};
};

struct FitOptions {
  /// What activations cost, in square millimetres of mean squared error: their squares, and their sizes.
  /// Channels that the rig's expression tables seldom use cost more.
  double ridge = 2e-4;
  double sparsity = 2e-4;
  /// The same for the square of a change from one frame to the next.
  double smoothness = 2e-3;
  int iterations = 30;         ///< Gauss-Newton steps at most
  std::vector<uint32_t> held;  ///< channels that stay where they are
};

struct FitResult {
  std::vector<float> activations;  ///< one a channel of the rig
  double share = 0.0;              ///< 1 - sum |u - v|^2 / sum |v|^2 over weighted vertices
  double error_mm = 0.0;  ///< mean distance left where the target moves more than 0.5 mm; else over all
  double rms_mm = 0.0;    ///< root mean square distance left over weighted vertices
  int iterations = 0;
  bool converged = false;
  Eigen::VectorXd
      displacements;  ///< 3 x #vertices, metres: the fitted pose, solved from rest as `pose` would
  /// By channel: how far the activation may go, all others following as suits best, before the root mean
  /// square error has risen by 0.05 mm (from the Hessian of the fit); 0 for channels that are not fitted.
  std::vector<double> spread;
  /// Pairs of channels in use that the target hardly tells apart: correlation beyond 0.9 in that Hessian's
  /// inverse.
  std::vector<std::pair<uint32_t, uint32_t>> alike;
};

/// Adds up what a fit leaves, place by place.
class Misses {
 public:
  /// `left`: from where the fit has a place to where it should be; `moved`: how far it should have moved;
  /// metres. `confidence` above 0.
  void add(double left, double moved, double confidence = 1.0);
  double motion() const { return whole_; }  ///< weighted squares of what should have moved
  /// Writes share, error_mm and rms_mm.
  void write(FitResult& result) const;

 private:
  double left_ = 0.0, whole_ = 0.0, confidence_ = 0.0, miss_ = 0.0, miss_moved_ = 0.0;
  size_t count_ = 0, count_moved_ = 0;
};

/// A pose and how its mean squared distance from a target answers activations.
struct Linearised {
  std::vector<uint32_t> channels;  ///< that rows and columns below stand for
  Eigen::MatrixXd hessian;         ///< Gauss-Newton, of half the mean squared distance, mm^2
  Eigen::VectorXd slope;           ///< of the same
  double mean_square = 0.0;        ///< mm^2, over weighted vertices
  double target_square = 0.0;      ///< of the target's own motion, mm^2
};

/// Finds the activations whose static pose comes nearest to targets: Gauss-Newton steps on the full
/// simulation, with contact, in the channels' ranges (Sifakis, Neverov & Fedkiw 2005, "Automatic
/// determination of facial muscle activations from sparse motion capture marker data", section 4), gradients
/// by the adjoint of the equilibrium.
///
/// Channels that only move the mandible, as its own three do, stay at rest, so that the answer is one; the
/// eyes turn as their meshes do, or as their lids show where nothing is known of the meshes.
class Fitter {
 public:
  explicit Fitter(Subject& subject, const FitOptions& options = {});

  /// Throws fascia::Error when the target has no confidence in any vertex that the rig moves.
  FitResult fit(const Target& target);
  /// The next frame of a take: begins at the last result and keeps near it.
  FitResult follow(const Target& target);

  /// The pose of `values` beside `target`; costs do not count. Throws fascia::Error when the target has no
  /// confidence in any vertex that the rig moves, or the pose has no derivative.
  Linearised linearised(const Target& target, const std::vector<float>& values);

  /// Other costs and steps from now on.
  void set_options(const FitOptions& options);

 private:
  FitResult solve(const Target& target, bool is_next);
  void take_weights(const Target& target);
  /// Half the gradient of the mean squared distance, by the adjoint or by the columns at hand.
  Eigen::VectorXd slope_of(const Eigen::VectorXd& difference, bool by_columns) const;
  /// Mean squared error and cost of `values`; poses the subject.
  double objective(const Target& target, const std::vector<float>& values, bool warm,
                   Eigen::VectorXd& difference);
  double cost(const std::vector<float>& values) const;
  bool linearise(const std::vector<float>& values);
  bool is_eye(uint32_t channel) const;
  /// Keeps the options' channels, and the gaze of each eye that is seen (left, right), where they are.
  void hold(const std::array<bool, 2>& eyes);
  void find_eyes(const Target& target, std::vector<float>& values);
  /// Half the Hessian of the mean squared error where vertices may slide along a surface.
  void gather_sliding();
  Vec3 weighted(Eigen::Index vertex, const Vec3& difference) const;
  Eigen::VectorXd step(const Eigen::VectorXd& slope, const std::vector<float>& values, double damping) const;
  void finish(const Target& target, FitResult& result);

  Subject* subject_;
  FitOptions options_;
  sim::Sensitivity sensitivity_;
  std::vector<uint32_t> driven_;    ///< channels fitted that tissue listens to, eyes among them by their lids
  std::vector<uint32_t> fitted_;    ///< those, then the jaw's
  std::vector<bool> is_held_;       ///< by channel
  std::vector<double> dearness_;    ///< by channel: cost beside that of a common one
  std::vector<float> last_;         ///< the last frame's activations
  std::vector<float> linear_at_;    ///< where the columns below were taken
  Eigen::MatrixXd node_columns_;    ///< 3 #nodes x #fitted
  Eigen::MatrixXd jaw_slopes_;      ///< 3 #vertices x 3
  Eigen::MatrixXd hessian_;         ///< #fitted square: of the mean squared error in mm^2, halved
  Eigen::VectorXd vertex_weights_;  ///< #vertices: confidence over its sum
  Eigen::VectorXd slide_normals_;   ///< of the target; empty: distances count in all directions
  bool is_sequence_ = false;
};

}  // namespace fascia::fit
