#include "builder/landmarks/registration.h"
#include "geometry/alignment.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
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

/// How far along the plane of `n` the nearest sample lies from `p`.
double overhang(const Neighbours& target, const Vec3& p, const Vec3& n) {
  static thread_local std::vector<size_t> near;
  static thread_local std::vector<double> squared;
  target.nearest(p, 1, near, squared);
  if (near.empty()) return std::numeric_limits<double>::infinity();
  const Vec3 off = target.samples().points[near.front()] - p;
  return (off - n.dot(off) * n).norm();
}

/// The points of one stage, where they are now, and which way the surface faces there.
struct Front {
  std::vector<int> used;
  std::vector<Vec3> base, at, normals;  ///< anchors first; these have no normals
};

Front front_of(const GenericFace& face, const std::vector<Anchor>& anchors, int stride,
               const splines::Warp& warp) {
  Front front;
  for (const Anchor& anchor : anchors)
    front.base.push_back(anchor.generic);
  for (size_t i = 0; i < face.points.size(); i += static_cast<size_t>(stride)) {
    const Vec3& p = face.points.points[i];
    const bool is_anchored = std::any_of(anchors.begin(), anchors.end(),
                                         [&](const Anchor& a) { return (a.generic - p).norm() < 5e-4; });
    if (is_anchored) continue;
    front.used.push_back(static_cast<int>(i));
    front.base.push_back(p);
  }
  front.at = warp(std::span<const Vec3>(front.base));
  // Two points beside each, carried along, give the turn of the tangent plane: cheaper than Jacobians.
  std::vector<Vec3> beside;
  for (int i : front.used) {
    const Vec3& n = face.points.normals[static_cast<size_t>(i)];
    const Vec3 u = n.unitOrthogonal();
    beside.push_back(face.points.points[static_cast<size_t>(i)] + 0.001 * u);
    beside.push_back(face.points.points[static_cast<size_t>(i)] + 0.001 * n.cross(u));
  }
  beside = warp(std::span<const Vec3>(beside));
  for (size_t k = 0; k < front.used.size(); ++k) {
    const Vec3& here = front.at[anchors.size() + k];
    const Vec3 n = (beside[2 * k] - here).cross(beside[2 * k + 1] - here);
    front.normals.push_back(n.norm() > 0.0 ? Vec3(n.normalized())
                                           : face.points.normals[static_cast<size_t>(front.used[k])]);
  }
  return front;
}

}  // namespace

RegistrationOptions coarse_fit() {
  RegistrationOptions options;
  options.stages = {{10, 3, 2}, {3, 3, 2}, {1, 3, 2}};
  options.last_reach = 0.008;
  return options;
}

Registration register_face(const GenericFace& face, const Samples& target_samples, const Placement& placement,
                           const std::vector<Anchor>& anchors, const RegistrationOptions& options,
                           const splines::Warp& start) {
  const Neighbours target(in_generic_frame(target_samples, placement));
  Registration fit;
  fit.placement = placement;
  fit.warp = start;
  const size_t pinned = anchors.size(), stages = options.stages.size();
  Front front;
  for (size_t stage = 0; stage < stages; ++stage) {
    const double share = stages > 1 ? static_cast<double>(stage) / static_cast<double>(stages - 1) : 1.0;
    const double reach = options.reach * std::pow(options.last_reach / options.reach, share);
    front = front_of(face, anchors, options.stages[stage].stride, fit.warp);
    splines::WarpOptions plate;
    plate.lambda = options.stages[stage].lambda;
    plate.weights.assign(front.base.size(), 1.0);
    std::vector<Vec3> goal = front.base;
    for (size_t a = 0; a < pinned; ++a) {
      goal[a] = placement.inverse(anchors[a].target);
      plate.weights[a] = anchors[a].weight;
    }
    for (int round = 0; round < options.stages[stage].rounds; ++round) {
      for (size_t i = pinned; i < front.base.size(); ++i) {
        const Foot foot = foot_of(target, front.at[i], front.normals[i - pinned], reach);
        const double off = foot.normal.dot(foot.point - front.at[i]);
        const Vec3 aside = foot.point - front.at[i] - off * foot.normal;
        goal[i] = foot.weight > 0.0 ? Vec3(front.at[i] + off * foot.normal + 0.15 * aside) : front.at[i];
        plate.weights[i] =
            std::max(1e-3, foot.weight * (0.1 + face.weights[static_cast<size_t>(front.used[i - pinned])]));
      }
      fit.warp = splines::fit_warp(front.base, goal, plate);
      front.at = fit.warp(std::span<const Vec3>(front.base));
    }
  }
  front = front_of(face, anchors, options.stages.back().stride, fit.warp);
  fit.used = front.used;
  for (size_t i = pinned; i < front.base.size(); ++i) {
    const Foot foot = foot_of(target, front.at[i], front.normals[i - pinned], 0.02);
    fit.residuals.push_back(foot.weight > 0.0 ? std::abs(foot.normal.dot(foot.point - front.at[i])) +
                                                    0.3 * (foot.point - front.at[i]).norm()
                                              : std::numeric_limits<double>::infinity());
    fit.feet.push_back(foot.point);
    fit.normals.push_back(foot.normal);
    fit.agreements.push_back(foot.weight > 0.0 ? foot.normal.dot(front.normals[i - pinned]) : -1.0);
    fit.overhangs.push_back(overhang(target, front.at[i], front.normals[i - pinned]));
  }
  return fit;
}

namespace {

/// Of `values`, one a point of the fit: that of the point nearest to `generic`, median of three.
double value_at(const GenericFace& face, const Registration& fit, const std::vector<double>& values,
                const Vec3& generic) {
  std::array<std::pair<double, double>, 3> nearest;  // squared distance, value
  nearest.fill({std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()});
  for (size_t i = 0; i < fit.used.size(); ++i) {
    const std::pair one((face.points.points[static_cast<size_t>(fit.used[i])] - generic).squaredNorm(),
                        values[i]);
    if (one < nearest.back()) nearest.back() = one;
    std::sort(nearest.begin(), nearest.end());
  }
  std::sort(nearest.begin(), nearest.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
  return nearest[1].second;
}

}  // namespace

double overhang_at(const GenericFace& face, const Registration& fit, const Vec3& generic) {
  return value_at(face, fit, fit.overhangs, generic);
}

double residual_at(const GenericFace& face, const Registration& fit, const Vec3& generic) {
  return value_at(face, fit, fit.residuals, generic);
}

Placement similarity_of(const GenericFace& face, const Registration& fit) {
  const std::vector<size_t> some = some_face_points(face, 2);
  std::vector<Vec3> from, to;
  for (size_t i : some) {
    from.push_back(face.points.points[i]);
    to.push_back(fit(face.points.points[i]));
  }
  const Mat4 map = similarity(from, to);
  Placement placement;
  placement.scale = map.topLeftCorner<3, 1>().norm();
  placement.rotation = map.topLeftCorner<3, 3>() / placement.scale;
  placement.shift = map.topRightCorner<3, 1>();
  return placement;
}

}  // namespace fascia::landmarks
