#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>
#include <vector>

#include "builder/splines/polyharmonic.h"
#include "builder/splines/warp.h"
#include "geometry/mesh.h"

namespace fascia::skull {

/// One point of the generic bone and where it belongs on the head.
///
/// With a `normal` the target is only known along it: in the plane across, it may slide with a standard
/// deviation of `slide_sd`. An unused observation says nothing.
struct Observation {
  Vec3 from = Vec3::Zero(), to = Vec3::Zero();  ///< m
  double sd = 0.001;                            ///< standard deviation, m
  Vec3 normal = Vec3::Zero();                   ///< unit, or zero: does not slide
  double slide_sd = 0;                          ///< m along the surface
  bool used = true;
};

/// How a tangent of the generic at `at` turns: the map's derivative along `tangent` is `target`.
struct TangentObservation {
  Vec3 at = Vec3::Zero(), tangent = Vec3::UnitX(), target = Vec3::UnitX();
  double sd = 0.2;  ///< of the target, about the angle in radians
};

/// The smoothed spline from generic bone to this head's, factored for fixed generic points and deviations:
/// as long as only targets move, every solve is a product.
///
/// Sliding targets are settled where the sum of bending energy, misfit and slide is least: a linear system in
/// the slides, as for sliding semilandmarks (F. Bookstein. 1997; P. Gunz et al. 2005), with B the bending
/// form of the smoothing spline and each slide held by its own deviation.
class BoneSystem {
 public:
  BoneSystem() = default;
  BoneSystem(std::span<const Observation> observations, std::span<const TangentObservation> tangents,
             double smoothing, double exponent);

  /// Settles the sliding targets and returns displacements, one row an observation, tangents after them.
  Eigen::MatrixXd displacements(std::span<const Observation> observations,
                                std::span<const TangentObservation> tangents) const;

  /// The map with these displacements.
  splines::Warp warp(const Eigen::MatrixXd& displacements) const;

  /// Gets ready for quick evaluation at `points`.
  void prepare(std::span<const Vec3> points);

  /// Where the prepared points go: `warp`, made by this system, of them, up to rounding.
  std::vector<Vec3> positions(const splines::Warp& warp) const;

 private:
  splines::Sites sites_;
  splines::SplineOptions options_;
  std::shared_ptr<const splines::Factorisation> factorisation_;
  Eigen::MatrixXd bending_;  // data to kernel coefficients: the bending form of the smoothing spline
  int values_ = 0;
  std::vector<Vec3> points_;
  Eigen::MatrixXd basis_;  // centres by points
};

}  // namespace fascia::skull
