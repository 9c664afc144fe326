#pragma once

#include <span>
#include <vector>

#include "builder/splines/polyharmonic.h"
#include "geometry/mesh.h"

namespace fascia::splines {

struct WarpOptions {
  double exponent = 1;          ///< 1: thin plate in space
  double lambda = 0;            ///< smoothing, see SplineOptions
  std::vector<double> weights;  ///< one a landmark, empty: 1 each
  int dimension = 3;            ///< 2: the plane
};

/// A map of space or the plane onto itself: x -> x + u(x), u a polyharmonic spline with affine part. A map of
/// the plane leaves z alone. The default is the identity.
class Warp {
 public:
  Warp() = default;
  /// `displacement` has as many outputs as dimensions.
  explicit Warp(Spline displacement);

  Vec3 operator()(const Vec3& point) const;
  std::vector<Vec3> operator()(std::span<const Vec3> points) const;
  TriangleMesh operator()(const TriangleMesh& mesh) const;

  /// Jacobian of the map at `point`. At a landmark of a warp with exponent 1, which has a kink there,
  /// that landmark's own term is left out.
  Mat3 jacobian(const Vec3& point) const;

  int dimension() const { return identity_ ? 3 : displacement_.dimension(); }
  bool identity() const { return identity_; }
  const Spline& displacement() const { return displacement_; }

 private:
  Spline displacement_;
  bool identity_ = true;
};

/// The warp that carries `source[i]` to `target[i]`. Affine maps are reproduced exactly; landmarks on a
/// plane or line leave the directions they say nothing about alone.
/// Throws Error when counts differ or landmarks coincide (see Factorisation).
Warp fit_warp(std::span<const Vec3> source, std::span<const Vec3> target, const WarpOptions& options = {});

}  // namespace fascia::splines
