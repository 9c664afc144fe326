#include "builder/landmarks/registration.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

namespace fascia::landmarks {

namespace {

Samples in_generic_frame(const Samples& target, const Placement& placement) {
  Samples samples;
  for (size_t i = 0; i < target.size(); ++i)
    samples.add(placement.inverse(target.points[i]), placement.rotation.transpose() * target.normals[i]);
  return samples;
}

struct Foot {
  Vec3 point, normal;
  double weight = 0.0;  ///< 0: none found
};

/// The tangent plane of the surface next to `p`, from samples that face as `n` does.
Foot foot_of(const Neighbours& target, const Vec3& p, const Vec3& n, double reach) {
  static thread_local std::vector<size_t> near;
  static thread_local std::vector<double> squared;
  target.nearest(p, 10, near, squared);
  Foot foot{Vec3::Zero(), Vec3::Zero(), 0.0};
  double total = 0.0, first = -1.0;
  for (size_t k = 0; k < near.size(); ++k) {
    const Vec3& normal = target.samples().normals[near[k]];
    if (normal.dot(n) < 0.4) continue;
    if (first < 0.0) first = squared[k];
    const double width = first + 4e-6;  // a little beyond the nearest: evens out noise
    const double weight = std::exp(-(squared[k] - first) / width);
    foot.point += weight * target.samples().points[near[k]];
    foot.normal += weight * normal;
    total += weight;
  }
  if (total <= 0.0 || first > reach * reach) return foot;
  foot.point /= total;
  foot.normal.normalize();
  const double ratio = std::sqrt(first) / reach;
  foot.weight = (1 - ratio * ratio) * (1 - ratio * ratio) * std::clamp(foot.normal.dot(n), 0.05, 1.0);
  return foot;
}

}  // namespace

Registration register_face(const GenericFace& face, const Samples& target_samples, const Placement& placement,
                           const std::vector<Anchor>& anchors, const RegistrationOptions& options) {
  const Neighbours target(in_generic_frame(target_samples, placement));
  Registration fit;
  fit.placement = placement;
  std::vector<Vec3> base, normals;
  for (const Anchor& anchor : anchors) base.push_back(anchor.generic);
  for (size_t i = 0; i < face.points.size(); i += static_cast<size_t>(options.stride)) {
    const Vec3& p = face.points.points[i];
    const bool is_anchored = std::any_of(anchors.begin(), anchors.end(), [&](const Anchor& a) { return (a.generic - p).norm() < 5e-4; });
    if (is_anchored) continue;
    fit.used.push_back(static_cast<int>(i));
    base.push_back(p);
  }
  const size_t free = anchors.size();
  const size_t stages = options.lambdas.size();
  std::vector<Vec3> at = base, goal = base;
  for (size_t i : fit.used) normals.push_back(face.points.normals[i]);
  splines::WarpOptions plate;
  plate.weights.assign(base.size(), 1.0);
  for (size_t a = 0; a < free; ++a) {
    goal[a] = placement.inverse(anchors[a].target);
    plate.weights[a] = anchors[a].weight;
  }
  for (size_t stage = 0; stage < stages; ++stage) {
    const double share = stages > 1 ? static_cast<double>(stage) / static_cast<double>(stages - 1) : 1.0;
    const double reach = options.reach * std::pow(options.last_reach / options.reach, share);
    plate.lambda = options.lambdas[stage];
    for (int round = 0; round < options.rounds; ++round) {
      for (size_t i = free; i < base.size(); ++i) {
        const Foot foot = foot_of(target, at[i], normals[i - free], reach);
        const double off = foot.normal.dot(foot.point - at[i]);
        const Vec3 aside = foot.point - at[i] - off * foot.normal;
        goal[i] = foot.weight > 0.0 ? Vec3(at[i] + off * foot.normal + 0.15 * aside) : at[i];
        plate.weights[i] = std::max(1e-3, foot.weight * (0.1 + face.weights[static_cast<size_t>(fit.used[i - free])]));
      }
      fit.warp = splines::fit_warp(base, goal, plate);
      at = fit.warp(std::span<const Vec3>(base));
    }
    for (size_t i = free; i < base.size(); ++i) {
      const Mat3 turn = fit.warp.jacobian(base[i]);
      const Vec3& n = face.points.normals[static_cast<size_t>(fit.used[i - free])];
      if (std::abs(turn.determinant()) > 1e-3) normals[i - free] = (turn.inverse().transpose() * n).normalized();
    }
  }
  for (size_t i = free; i < base.size(); ++i) {
    const Foot foot = foot_of(target, at[i], normals[i - free], 0.02);
    fit.residuals.push_back(foot.weight > 0.0 ? std::abs(foot.normal.dot(foot.point - at[i])) + 0.3 * (foot.point - at[i]).norm()
                                              : std::numeric_limits<double>::infinity());
    fit.agreements.push_back(foot.weight > 0.0 ? foot.normal.dot(normals[i - free]) : -1.0);
  }
  return fit;
}

double fitted_share(const GenericFace& face, const Registration& fit) {
  double good = 0.0, total = 0.0;
  for (size_t i = 0; i < fit.used.size(); ++i) {
    if (!face.is_face[static_cast<size_t>(fit.used[i])]) continue;
    total += 1.0;
    const double near = std::exp(-std::pow(fit.residuals[i] / 0.003, 2));
    good += near * std::clamp((fit.agreements[i] - 0.5) / 0.4, 0.0, 1.0);
  }
  return total > 0.0 ? good / total : 0.0;
}

}  // namespace fascia::landmarks
