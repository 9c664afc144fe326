#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "sim/reference_solver.h"

// How a static pose moves with what drives it: the adjoint of the equilibrium, gradient(x, activations) = 0.
// For a loss of the pose, d loss / d a = -lambda . d gradient / d a with H lambda = d loss / d x, H the
// Hessian where the pose stands (Nocedal & Wright 2006, section 10.1; Sifakis, Neverov & Fedkiw 2005 for
// faces).
namespace fascia::sim {

AdjointResult ReferenceSolver::static_gradient(const Controls& controls, std::span<const Vec3> slope,
                                               std::span<double> by_channel, std::array<double, 3>& by_jaw,
                                               const AdjointOptions& options) {
  AdjointResult result;
  const auto& unknowns = model_->unknowns();
  const size_t nodes = pose_.size();
  model_->place(controls, pose_frame_);
  Adjoint& a = adjoint_;
  a.resize(nodes, unknowns.size());
  // Conjugate gradients on H lambda = slope, the rest factor as preconditioner.
  std::fill(a.lambda.begin(), a.lambda.end(), Vec3::Zero());
  double size = 0.0;
  for (size_t i = 0; i < unknowns.size(); ++i) {
    a.residual[i] = unknowns[i] < slope.size() ? slope[unknowns[i]] : Vec3(Vec3::Zero());
    a.packed[i] = a.residual[i];
    size += a.residual[i].squaredNorm();
  }
  model_->pose_factor().solve(a.packed, a.scratch);
  std::fill(a.direction.begin(), a.direction.end(), Vec3::Zero());
  double energy = 0.0;
  for (size_t i = 0; i < unknowns.size(); ++i) {
    a.direction[unknowns[i]] = a.packed[i];
    energy += a.packed[i].dot(a.residual[i]);
  }
  double left = size;
  while (result.iterations < options.iterations && left > options.tolerance * options.tolerance * size &&
         energy > 0.0) {
    model_->hessian_times(pose_frame_, pose_.data(), a.direction.data(), a.product.data(), a.work);
    double curvature = 0.0;
    for (const uint32_t i : unknowns)
      curvature += a.direction[i].dot(a.product[i]);
    if (!(curvature > 0.0)) break;  // non-positive curvature: keep the best iterate
    const double length = energy / curvature;
    left = 0.0;
    for (size_t i = 0; i < unknowns.size(); ++i) {
      a.lambda[unknowns[i]] += length * a.direction[unknowns[i]];
      a.residual[i] -= length * a.product[unknowns[i]];
      a.packed[i] = a.residual[i];
      left += a.residual[i].squaredNorm();
    }
    model_->pose_factor().solve(a.packed, a.scratch);
    double next = 0.0;
    for (size_t i = 0; i < unknowns.size(); ++i)
      next += a.packed[i].dot(a.residual[i]);
    for (size_t i = 0; i < unknowns.size(); ++i)
      a.direction[unknowns[i]] = a.packed[i] + (next / energy) * a.direction[unknowns[i]];
    energy = next;
    ++result.iterations;
  }
  result.residual = size > 0.0 ? std::sqrt(left / size) : 0.0;
  result.converged = result.residual <= options.tolerance;

  std::fill(by_channel.begin(), by_channel.end(), 0.0);
  model_->channel_slopes(pose_frame_, controls, pose_.data(), a.lambda.data(), by_channel);
  for (double& value : by_channel)
    value = -value;
  // The jaw moves bones, anchors and prescribed nodes all at once: differences of the gradient, at free
  // nodes' fixed places.
  for (size_t k = 0; k < 3; ++k) {
    const float step = 1e-3F;
    double ends[2];
    for (int end = 0; end < 2; ++end) {
      Controls moved = controls;
      float* const value = k == 0 ? &moved.jaw.open : k == 1 ? &moved.jaw.forward : &moved.jaw.lateral;
      *value += end == 0 ? -step : step;
      model_->place(moved, pose_frame_);
      double sum = 0.0;
      for (size_t i = 0; i < nodes; ++i) {
        a.moved[i] = model_->prescribed(i) ? pose_frame_.carried[i] : pose_[i];
        if (model_->prescribed(i) && i < slope.size()) sum += slope[i].dot(a.moved[i] - pose_[i]);
      }
      model_->energy(pose_frame_, a.moved.data(), a.product.data());
      for (const uint32_t i : unknowns)
        sum -= a.lambda[i].dot(a.product[i]);
      ends[end] = sum;
    }
    const JawPose low =
        clamped({controls.jaw.open - step, controls.jaw.forward - step, controls.jaw.lateral - step});
    const JawPose high =
        clamped({controls.jaw.open + step, controls.jaw.forward + step, controls.jaw.lateral + step});
    const double width = k == 0   ? high.open - low.open
                         : k == 1 ? high.forward - low.forward
                                  : high.lateral - low.lateral;
    by_jaw[k] = width > 0.0 ? (ends[1] - ends[0]) / width : 0.0;
  }
  model_->place(controls, pose_frame_);
  return result;
}

}  // namespace fascia::sim
