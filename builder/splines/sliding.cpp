#include "builder/splines/sliding.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <string>

#include "geometry/error.h"

namespace fascia::splines {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

double energy(const MatrixXd& bending, const MatrixXd& data) {
  return (data.transpose() * bending * data).trace();
}

MatrixXd as_rows(const std::vector<Vec3>& points, int dimension) {
  MatrixXd out(static_cast<Index>(points.size()), dimension);
  for (size_t i = 0; i < points.size(); ++i)
    out.row(static_cast<Index>(i)) = points[i].head(dimension).transpose();
  return out;
}

Foot nearest_on(const std::vector<Vec3>& points, bool closed, const Vec3& query) {
  Foot best;
  double least = std::numeric_limits<double>::infinity();
  const size_t count = points.size(), segments = closed ? count : count - 1;
  for (size_t i = 0; i < segments; ++i) {
    const Vec3 along = points[(i + 1) % count] - points[i];
    const double squared = along.squaredNorm();
    if (squared == 0) continue;
    const double t = std::clamp((query - points[i]).dot(along) / squared, 0.0, 1.0);
    const Vec3 foot = points[i] + t * along;
    const double distance = (query - foot).squaredNorm();
    if (distance >= least) continue;
    least = distance;
    best = {foot, along / std::sqrt(squared)};
  }
  return best;
}

void check(const SlidingLandmarks& landmarks, std::span<const Carrier> carriers) {
  if (landmarks.source.size() != landmarks.target.size() ||
      landmarks.source.size() != landmarks.carrier.size())
    throw Error("sliding: " + std::to_string(landmarks.source.size()) + " sources, " +
                std::to_string(landmarks.target.size()) + " targets and " +
                std::to_string(landmarks.carrier.size()) + " carriers; give one of each a landmark");
  for (int carrier : landmarks.carrier)
    if (carrier >= static_cast<int>(carriers.size()))
      throw Error("sliding: carrier " + std::to_string(carrier) + " of " + std::to_string(carriers.size()));
  for (const Carrier& carrier : carriers)
    if (!carrier.nearest) throw Error("sliding: a carrier has no function to find its nearest point");
}

// How far each landmark may go, so that neighbours that come towards each other do not meet.
std::vector<double> step_limits(const SlidingLandmarks& landmarks, const std::vector<Vec3>& target,
                                double share) {
  std::vector<double> out(target.size(), std::numeric_limits<double>::infinity());
  for (size_t i = 0; i < target.size(); ++i) {
    if (landmarks.carrier[i] < 0) continue;
    for (size_t j = 0; j < target.size(); ++j) {
      const bool neighbour =
          j != i && (landmarks.carrier[j] == landmarks.carrier[i] || landmarks.carrier[j] < 0);
      const double distance = (target[i] - target[j]).norm();
      if (neighbour && distance > 0) out[i] = std::min(out[i], share * distance);
    }
  }
  return out;
}

struct Slider {
  const SlidingLandmarks& landmarks;
  std::span<const Carrier> carriers;
  int dimension;

  Foot foot(size_t i, const Vec3& at) const {
    return carriers[static_cast<size_t>(landmarks.carrier[i])].nearest(at);
  }

  std::vector<Vec3> placed(std::vector<Vec3> target) const {
    for (size_t i = 0; i < target.size(); ++i)
      if (landmarks.carrier[i] >= 0) target[i] = foot(i, target[i]).position;
    return target;
  }

  std::vector<Freedom> freedoms(const std::vector<Vec3>& target) const {
    std::vector<Freedom> out;
    for (size_t i = 0; i < target.size(); ++i) {
      if (landmarks.carrier[i] < 0) continue;
      const Vec3 direction = foot(i, target[i]).direction;
      const bool curve = carriers[static_cast<size_t>(landmarks.carrier[i])].kind == Carrier::Kind::curve;
      if (!(direction.norm() > 0)) continue;  // a point of the carrier without tangent holds the landmark
      if (curve) {
        out.push_back({static_cast<int>(i), direction.normalized()});
        continue;
      }
      for (const Vec3& tangent : tangents(direction))
        out.push_back({static_cast<int>(i), tangent});
    }
    return out;
  }

  // The targets after `share` of the step, capped a landmark and put back on the carriers.
  std::vector<Vec3> moved(const std::vector<Vec3>& target, const MatrixXd& step, double share,
                          const std::vector<double>& limits) const {
    std::vector<Vec3> out = target;
    for (size_t i = 0; i < target.size(); ++i) {
      if (landmarks.carrier[i] < 0) continue;
      Vec3 shift = Vec3::Zero();
      shift.head(dimension) = share * step.row(static_cast<Index>(i)).transpose();
      if (shift.norm() > limits[i]) shift *= limits[i] / shift.norm();
      out[i] += shift;
    }
    return placed(std::move(out));
  }
};

}  // namespace

RelaxResult relax(const MatrixXd& bending, const MatrixXd& data, std::span<const Freedom> freedoms) {
  if (bending.rows() != data.rows() || bending.cols() != data.rows() || data.cols() > 3)
    throw Error("relax: the bending matrix is for " + std::to_string(bending.rows()) + " data, given are " +
                std::to_string(data.rows()) + " by " + std::to_string(data.cols()));
  const Index count = static_cast<Index>(freedoms.size()), outputs = data.cols();
  RelaxResult result{data, VectorXd::Zero(count), energy(bending, data), 0};
  result.energy_after = result.energy_before;
  if (count == 0) return result;
  const MatrixXd force = bending * data;
  MatrixXd A(count, count);
  VectorXd right(count);
  for (Index i = 0; i < count; ++i) {
    const Freedom& f = freedoms[static_cast<size_t>(i)];
    if (f.row < 0 || f.row >= data.rows())
      throw Error("relax: row " + std::to_string(f.row) + " is out of range");
    right[i] = -force.row(f.row).dot(f.direction.head(outputs));
    for (Index j = 0; j <= i; ++j) {
      const Freedom& g = freedoms[static_cast<size_t>(j)];
      A(i, j) = bending(f.row, g.row) * f.direction.head(outputs).dot(g.direction.head(outputs));
    }
  }
  // Where all may slide together (an affine motion costs nothing) the least ridge picks the shortest step.
  const double ridge = 1e-13 * A.diagonal().maxCoeff() + 1e-300;
  A.diagonal().array() += ridge;
  const Eigen::LLT<MatrixXd> cholesky(A.selfadjointView<Eigen::Lower>());
  result.steps = cholesky.info() == Eigen::Success
                     ? VectorXd(cholesky.solve(right))
                     : VectorXd(MatrixXd(A.selfadjointView<Eigen::Lower>()).ldlt().solve(right));
  if (!result.steps.allFinite())
    throw Error("relax: the freedoms leave the data undetermined; hold some of them");
  for (Index i = 0; i < count; ++i) {
    const Freedom& f = freedoms[static_cast<size_t>(i)];
    result.data.row(f.row) += result.steps[i] * f.direction.head(outputs).transpose();
  }
  result.energy_after = energy(bending, result.data);
  return result;
}

Carrier polyline_carrier(std::vector<Vec3> points, bool closed) {
  double length = 0;
  for (size_t i = 1; i < points.size(); ++i)
    length += (points[i] - points[i - 1]).norm();
  if (!(length > 0) || !std::isfinite(length))
    throw Error("sliding: a curve needs two points that differ, all finite");
  Carrier carrier;
  carrier.kind = Carrier::Kind::curve;
  carrier.nearest = [points = std::move(points), closed](const Vec3& query) {
    return nearest_on(points, closed, query);
  };
  return carrier;
}

SlidingResult slide(const SlidingLandmarks& landmarks, std::span<const Carrier> carriers,
                    const SlidingOptions& options) {
  check(landmarks, carriers);
  SplineOptions spline;
  spline.dimension = options.dimension;
  spline.exponent = options.exponent;
  spline.lambda = options.lambda;
  Sites sites;
  sites.points = landmarks.source;
  sites.weights = options.weights;
  const MatrixXd bending = Factorisation(sites, spline).bending_matrix();
  const Slider slider{landmarks, carriers, options.dimension};

  SlidingResult result;
  result.target = slider.placed(landmarks.target);
  MatrixXd data = as_rows(result.target, options.dimension);
  result.energy_before = result.energy_after = energy(bending, data);
  // Below this the energy is rounding noise of an affine map.
  const double noise = 1e-13 * bending.diagonal().maxCoeff() * data.squaredNorm();
  while (result.iterations < options.iterations && !result.converged) {
    ++result.iterations;
    const RelaxResult relaxed = relax(bending, data, slider.freedoms(result.target));
    const std::vector<double> limits = step_limits(landmarks, result.target, options.largest_step);
    const double before = result.energy_after;
    for (double share = 1; share > 1e-3; share /= 2) {
      std::vector<Vec3> candidate = slider.moved(result.target, relaxed.data - data, share, limits);
      const MatrixXd candidate_data = as_rows(candidate, options.dimension);
      const double value = energy(bending, candidate_data);
      if (value >= before) continue;
      result.target = std::move(candidate);
      data = candidate_data;
      result.energy_after = value;
      break;
    }
    result.converged =
        before - result.energy_after <= options.tolerance * before || result.energy_after <= noise;
  }
  return result;
}

}  // namespace fascia::splines
