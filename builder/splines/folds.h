#pragma once

// Detection and correction of fold-over of a deformation.
//
// This work is based on:
// S. Joshi, M. Miller. Landmark matching via large deformation diffeomorphisms. 2000 (small steps composed)
// G. Christensen, R. Rabbitt, M. Miller. Deformable templates using large deformation kinematics. 1996

#include <span>
#include <vector>

#include "builder/splines/warp.h"
#include "geometry/mesh.h"

namespace fascia::splines {

/// Warps one after the other.
class WarpSequence {
 public:
  WarpSequence() = default;
  explicit WarpSequence(std::vector<Warp> steps) : steps_(std::move(steps)) {}

  const std::vector<Warp>& steps() const { return steps_; }
  Vec3 operator()(const Vec3& point) const;
  std::vector<Vec3> operator()(std::span<const Vec3> points) const;
  TriangleMesh operator()(const TriangleMesh& mesh) const;

  /// Product of the steps' Jacobians.
  Mat3 jacobian(const Vec3& point) const;

 private:
  std::vector<Warp> steps_;
};

struct FoldOptions {
  int resolution = 20;          ///< grid points along the longest side of the region
  double least_allowed = 0.02;  ///< Jacobian determinants must stay above: 1 keeps volume, 0 is flat
};

struct FoldReport {
  double least_determinant = 1;
  Vec3 where = Vec3::Zero();  ///< of the least determinant, in the source
  int samples = 0;
  int folded = 0;  ///< samples at or below the allowed least
  bool sound() const { return folded == 0; }
};

/// The least Jacobian determinant of `map` in `region`: on a grid, around each landmark inside it (a thin
/// plate in space has its extremes there), and then downhill from the worst. A sampled answer: folds much
/// smaller than the grid's cells and away from landmarks can be missed.
/// Throws Error for an empty region or a resolution below 2.
FoldReport check_folds(const WarpSequence& map, const Bounds& region, const FoldOptions& options = {});
FoldReport check_folds(const Warp& map, const Bounds& region, const FoldOptions& options = {});

enum class FoldRemedy {
  compose,  ///< landmarks are interpolated exactly: composition of 2, 4, 8, ... steps, each without a fold
  smooth,   ///< one spline that misses the landmarks by as little as the least sufficient lambda allows
};

struct UnfoldedResult {
  WarpSequence map;
  double lambda = 0;  ///< of smooth
  FoldReport report;
  double largest_miss = 0;  ///< of a landmark, in the user's unit
};

/// The warp from `source` to `target` when it does not fold in `region`, otherwise one mended by `remedy`.
/// Throws Error when the landmarks are mirrored or tangled so that the remedy fails; the message names the
/// other.
UnfoldedResult fit_unfolded(std::span<const Vec3> source, std::span<const Vec3> target, const Bounds& region,
                            FoldRemedy remedy, const WarpOptions& warp = {}, const FoldOptions& options = {});

}  // namespace fascia::splines
