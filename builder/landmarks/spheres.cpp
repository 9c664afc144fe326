#include "builder/landmarks/spheres.h"

#include <algorithm>
#include <bitset>
#include <cmath>
#include <cstdint>

#include "geometry/alignment.h"

namespace fascia::landmarks {

namespace {

/// Cells of the sphere of directions: 5 x 5 on each face of a cube.
constexpr int cells = 6 * 25;

int direction_cell(const Vec3& d) {
  Eigen::Index axis;
  d.cwiseAbs().maxCoeff(&axis);
  const double depth = std::abs(d[axis]);
  if (!(depth > 0.0)) return 0;
  const auto step = [&](double v) { return std::clamp(static_cast<int>(2.5 * (v / depth + 1.0)), 0, 4); };
  const int side = static_cast<int>(axis) * 2 + (d[axis] > 0 ? 1 : 0);
  return side * 25 + step(d[(axis + 1) % 3]) * 5 + step(d[(axis + 2) % 3]);
}

struct Lump {
  Ball ball;
  double share = 0.0;  ///< of the directions that are covered
};

bool follows(const Ball& ball, const Vec3& point, const Vec3& normal) {
  const Vec3 from = point - ball.centre;
  const double distance = from.norm();
  return std::abs(distance - ball.radius) < 0.22 * ball.radius && normal.dot(from) > 0.6 * distance;
}

double covered_share(const Ball& ball, const Samples& samples, size_t stride) {
  std::bitset<cells> covered;
  for (size_t i = 0; i < samples.size(); i += stride)
    if (follows(ball, samples.points[i], samples.normals[i])) {
      // Neighbouring samples stand for their cell only; a head on a whole body has few of them.
      covered.set(static_cast<size_t>(direction_cell(samples.points[i] - ball.centre)));
    }
  return static_cast<double>(covered.count()) / cells;
}

Ball refitted(const Ball& ball, const Samples& samples) {
  std::vector<Vec3> inliers;
  for (size_t i = 0; i < samples.size(); ++i)
    if (follows(ball, samples.points[i], samples.normals[i])) inliers.push_back(samples.points[i]);
  const Ball fit = fit_ball(inliers);
  return inliers.size() > 12 && fit.radius > 0.5 * ball.radius && fit.radius < 2.0 * ball.radius ? fit : ball;
}

/// The sphere that two points with normals lie on, if they agree on one.
bool through_pair(const Samples& samples, size_t i, size_t j, Ball& ball) {
  const Vec3 chord = samples.points[j] - samples.points[i], turn = samples.normals[j] - samples.normals[i];
  const double turned = turn.squaredNorm();
  if (turned < 0.3) return false;
  ball.radius = chord.dot(turn) / turned;
  if (!(ball.radius > 0.0)) return false;
  const Vec3 from_i = samples.points[i] - ball.radius * samples.normals[i];
  const Vec3 from_j = samples.points[j] - ball.radius * samples.normals[j];
  ball.centre = 0.5 * (from_i + from_j);
  return (from_i - from_j).norm() < 0.35 * ball.radius;
}

Samples thinned(const Samples& samples, size_t stride) {
  Samples thin;
  for (size_t i = 0; i < samples.size(); i += stride)
    thin.add(samples.points[i], samples.normals[i]);
  return thin;
}

}  // namespace

Ball fit_ball(const std::vector<Vec3>& points) {
  const Sphere sphere = least_squares_sphere(points);
  return {sphere.centre, sphere.radius};
}

std::vector<Ball> round_lumps(const Samples& samples, int count) {
  std::vector<Lump> lumps;
  std::vector<Ball> result;
  if (samples.size() < 12) return result;
  const double extent = bounds(samples.points).size().norm();
  uint64_t state = 1;
  const auto draw = [&](size_t below) {
    state = state * 6364136223846793005ULL + 1442695040888963407ULL;
    return static_cast<size_t>(state >> 33) % below;
  };
  // The head of a whole character holds few samples: pairs are drawn near each other as well as far apart, by
  // neighbours among all samples, every fourth, every sixteenth.
  std::vector<size_t> near;
  std::vector<double> squared;
  const size_t judging = std::max<size_t>(1, samples.size() / 1500);
  for (size_t thinning : {1u, 4u, 16u, 64u}) {
    const Samples thin = thinned(samples, thinning);
    const Neighbours tree(thin);
    for (int round = 0; round < 300; ++round) {
      const size_t i = draw(thin.size());
      tree.nearest(thin.points[i], static_cast<int>(std::min<size_t>(thin.size(), 40)), near, squared);
      for (int pair = 0; pair < 3; ++pair) {
        Lump lump;
        if (!through_pair(thin, i, near[draw(near.size())], lump.ball) || lump.ball.radius > 0.6 * extent ||
            lump.ball.radius < 0.01 * extent)
          continue;
        lump.share = covered_share(lump.ball, samples, judging);
        if (lump.share > 0.05) lumps.push_back(lump);
      }
    }
  }
  std::stable_sort(lumps.begin(), lumps.end(),
                   [](const Lump& a, const Lump& b) { return a.share > b.share; });
  if (lumps.size() > 40) lumps.resize(40);
  for (Lump& lump : lumps) {
    for (int round = 0; round < 3; ++round)
      lump.ball = refitted(lump.ball, samples);
    lump.share = covered_share(lump.ball, samples, 1);
  }
  std::stable_sort(lumps.begin(), lumps.end(),
                   [](const Lump& a, const Lump& b) { return a.share > b.share; });
  for (const Lump& lump : lumps) {
    const bool is_known = std::any_of(result.begin(), result.end(), [&](const Ball& ball) {
      return (ball.centre - lump.ball.centre).norm() < 0.35 * ball.radius &&
             std::abs(std::log(ball.radius / lump.ball.radius)) < 0.35;
    });
    if (!is_known && static_cast<int>(result.size()) < count - 1) result.push_back(lump.ball);
  }
  result.push_back(fit_ball(samples.points));
  return result;
}

}  // namespace fascia::landmarks
