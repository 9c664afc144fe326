#include "builder/landmarks/placement.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace fascia::landmarks {

namespace {

using Row7 = Eigen::Matrix<double, 1, 7>;
using Mat7 = Eigen::Matrix<double, 7, 7>;

struct Match {
  Vec3 from, to, normal;
  double weight, distance;
};

/// Closest samples that face the same way; distances in metres of the generic head.
std::vector<Match> matches(const GenericFace& face, const Neighbours& target, const Placement& placement,
                           size_t stride) {
  std::vector<Match> found;
  std::vector<size_t> near;
  std::vector<double> squared;
  for (size_t i = 0; i < face.points.size(); i += stride) {
    if (face.weights[i] <= 0.0) continue;
    const Vec3 p = placement(face.points.points[i]), n = placement.rotation * face.points.normals[i];
    target.nearest(p, 2, near, squared);
    for (size_t k = 0; k < near.size(); ++k) {
      const Vec3& other = target.samples().normals[near[k]];
      if (other.dot(n) < 0.5) continue;
      const Vec3& q = target.samples().points[near[k]];
      found.push_back({p, q, other, face.weights[i], std::sqrt(squared[k]) / placement.scale});
      break;
    }
  }
  return found;
}

/// The distance below which `share` of the matches lie.
double quantile(const std::vector<Match>& all, double share) {
  std::vector<double> distances;
  for (const Match& m : all)
    distances.push_back(m.distance);
  const auto at =
      distances.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(distances.size() - 1));
  std::nth_element(distances.begin(), at, distances.end());
  return *at;
}

}  // namespace

Placement refine_placement(const GenericFace& face, const Neighbours& target, const Placement& start,
                           int rounds, int stride, double* residual, const std::vector<Anchor>& anchors) {
  Placement placement = start;
  if (residual) *residual = 1.0;
  for (int round = 0; round < rounds; ++round) {
    const std::vector<Match> all = matches(face, target, placement, static_cast<size_t>(stride));
    if (all.size() < 20) return start;
    const double cut = std::max(0.004, 2.5 * quantile(all, 0.6));
    Vec3 pivot = Vec3::Zero();
    for (const Match& m : all)
      pivot += m.from / static_cast<double>(all.size());
    Mat7 left = Mat7::Zero();
    Eigen::Matrix<double, 7, 1> right = Eigen::Matrix<double, 7, 1>::Zero();
    double sum = 0.0, total = 0.0;
    // Unknowns: turn, shift and growth, all in units of the head's size about the pivot.
    const auto hold = [&](const Vec3& from, const Vec3& to, const Vec3& n, double weight) {
      const Vec3 arm = (from - pivot) / placement.scale;
      Row7 row;
      row << arm.cross(n).transpose(), n.transpose(), arm.dot(n);
      left += weight * row.transpose() * row;
      right += weight * row.transpose() * n.dot(to - from) / placement.scale;
    };
    for (const Match& m : all) {
      const double ratio = m.distance / cut;
      if (ratio >= 1.0) continue;
      const double weight = m.weight * (1 - ratio * ratio) * (1 - ratio * ratio);
      sum += m.weight * m.distance;
      total += m.weight;
      // The plane through the match counts fully; the point itself a little, which keeps bare spheres still.
      hold(m.from, m.to, m.normal, weight);
      for (int axis = 0; axis < 3; ++axis)
        hold(m.from, m.to, Vec3::Unit(axis), 0.05 * weight);
    }
    const double anchor_weight = total / static_cast<double>(std::max<size_t>(1, anchors.size()));
    for (const Anchor& anchor : anchors)
      for (int axis = 0; axis < 3; ++axis)
        hold(placement(anchor.generic), anchor.target, Vec3::Unit(axis), anchor_weight);
    if (total <= 0.0) return start;
    if (residual) *residual = sum / total;
    left.diagonal().array() += 1e-9 * left.trace();
    const Eigen::Matrix<double, 7, 1> step = left.ldlt().solve(right);
    const Vec3 turn = step.head<3>();
    const double angle = std::min(turn.norm(), 0.5), growth = std::clamp(step[6], -0.15, 0.15);
    const Mat3 rotation =
        angle > 1e-12 ? Eigen::AngleAxisd(angle, turn.normalized()).toRotationMatrix() : Mat3::Identity();
    // x -> pivot + (1 + growth) rotation (x - pivot) + scale * shift
    const Vec3 moved = pivot + placement.scale * Vec3(step.segment<3>(3)) +
                       (1.0 + growth) * (rotation * (placement.shift - pivot));
    placement.shift = moved;
    placement.rotation = rotation * placement.rotation;
    placement.scale *= 1.0 + growth;
    if (angle < 1e-4 && std::abs(growth) < 1e-4 && step.segment<3>(3).norm() < 1e-5) break;
  }
  return placement;
}

}  // namespace fascia::landmarks
