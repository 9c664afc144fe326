#pragma once

// Data that may move: semilandmarks that slide along curves and over surfaces, vectors of which only a part
// is known. Free components are chosen to minimise the bending energy.
//
// This work is based on:
// F. Bookstein. Landmark methods for forms without landmarks. 1997
// P. Gunz, P. Mitteroecker, F. Bookstein. Semilandmarks in three dimensions. 2005

#include <Eigen/Core>
#include <functional>
#include <span>
#include <vector>

#include "builder/splines/polyharmonic.h"
#include "geometry/mesh.h"

namespace fascia::splines {

/// Row `row` of the data may change by any multiple of `direction` (as many entries as there are outputs).
struct Freedom {
  int row = 0;
  Vec3 direction = Vec3::Zero();
};

struct RelaxResult {
  Eigen::MatrixXd data;                        ///< the data with the freedoms used
  Eigen::VectorXd steps;                       ///< multiple of each freedom's direction
  double energy_before = 0, energy_after = 0;  ///< y^T B y summed over outputs
};

/// The data of least bending energy within their freedoms: t = -(U^T B U)^-1 U^T B y0, y = y0 + U t.
/// `bending` is Factorisation::bending_matrix(), `data` rows by 2 or 3. Freedoms that cannot lower the energy
/// (everything slides) are left where they are. Throws Error when shapes do not match.
RelaxResult relax(const Eigen::MatrixXd& bending, const Eigen::MatrixXd& data,
                  std::span<const Freedom> freedoms);

/// What a semilandmark slides on: the nearest point of a curve or surface, and there the unit tangent of the
/// curve or the unit normal of the surface.
struct Foot {
  Vec3 position = Vec3::Zero();
  Vec3 direction = Vec3::Zero();
};

struct Carrier {
  enum class Kind { curve, surface };
  Kind kind = Kind::curve;
  std::function<Foot(const Vec3&)> nearest;
};

/// A polyline as carrier; `closed` joins its last point to its first. Throws Error for fewer than two points
/// or points that all coincide.
Carrier polyline_carrier(std::vector<Vec3> points, bool closed = false);

struct SlidingLandmarks {
  std::vector<Vec3> source;
  std::vector<Vec3> target;  ///< first guess of the sliding ones
  std::vector<int> carrier;  ///< index into the carriers, -1 for a landmark that stays
};

struct SlidingOptions {
  double exponent = 1;
  double lambda = 0;            ///< see SplineOptions
  std::vector<double> weights;  ///< one a landmark, empty: 1 each
  int dimension = 3;
  int iterations = 30;
  double tolerance = 1e-4;     ///< stop when the energy falls by less than this share
  double largest_step = 0.45;  ///< of the distance to the nearest neighbour on the same carrier
};

struct SlidingResult {
  std::vector<Vec3> target;  ///< on the carriers
  double energy_before = 0;  ///< of the landmarks as given, put on their carriers
  double energy_after = 0;
  int iterations = 0;
  bool converged = false;
};

/// Slides the targets along their carriers until the thin plate from source to target bends least. The
/// energy never rises: a step that raises it after the landmarks are put back on their carriers is halved.
/// Steps end short of half the way to a neighbour, so that none slides past another.
/// Throws Error when counts differ, a carrier index is out of range or the sources coincide.
SlidingResult slide(const SlidingLandmarks& landmarks, std::span<const Carrier> carriers,
                    const SlidingOptions& options = {});

}  // namespace fascia::splines
