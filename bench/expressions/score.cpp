#include "bench/expressions/score.h"

#include <Eigen/Geometry>

namespace fascia::bench {
namespace {

/// How the normal of a triangle at rest lies to that of the same triangle after `moved`.
double facing(const std::vector<Vec3>& rest, const Triangle& t, const Eigen::VectorXd& moved) {
  const auto place = [&](int corner, bool is_moved) -> Vec3 {
    const int v = t[static_cast<size_t>(corner)];
    return rest[static_cast<size_t>(v)] + (is_moved ? Vec3(moved.segment<3>(3 * v)) : Vec3(Vec3::Zero()));
  };
  const auto normal = [&](bool is_moved) {
    const Vec3 a = place(0, is_moved);
    return Vec3((place(1, is_moved) - a).cross(place(2, is_moved) - a).stableNormalized());
  };
  return normal(false).dot(normal(true));
}

}  // namespace

Score score(const std::vector<Vec3>& rest, const std::vector<Triangle>& triangles,
            const Eigen::VectorXd& simulated, const Eigen::VectorXd& truth) {
  Score result;
  const double all = truth.squaredNorm(), own = simulated.squaredNorm(), both = simulated.dot(truth);
  double error = 0.0;
  int moving = 0;
  for (Eigen::Index v = 0; 3 * v + 2 < truth.size(); ++v) {
    if (truth.segment<3>(3 * v).norm() <= 5e-4) continue;
    error += (simulated - truth).segment<3>(3 * v).norm();
    ++moving;
  }
  result.explained = 1.0 - (simulated - truth).squaredNorm() / all;
  result.best_scale = own > 0.0 ? both / own : 0.0;
  result.at_best_scale = own > 0.0 ? both * both / (own * all) : 0.0;
  result.error_mm = moving > 0 ? 1e3 * error / moving : 0.0;
  for (const Triangle& t : triangles)
    if (facing(rest, t, simulated) < -0.2 && facing(rest, t, truth) > 0.2) ++result.turned;
  return result;
}

}  // namespace fascia::bench
