#include "builder/splines/folds.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <string>

#include "geometry/error.h"

namespace fascia::splines {
namespace {

struct Judge {
  const WarpSequence& map;
  const FoldOptions& options;
  FoldReport report;

  double determinant(const Vec3& point) const {
    double least = 1, product = 1;
    Vec3 at = point;
    for (const Warp& step : map.steps()) {
      const double factor = step.jacobian(at).determinant();
      least = std::min(least, factor);
      product *= factor;
      at = step(at);
    }
    // Two folds in a row would cancel in the product.
    return least <= 0 ? std::min(least, product) : product;
  }

  void look(const Vec3& point) {
    const double value = determinant(point);
    ++report.samples;
    if (!(value > options.least_allowed)) ++report.folded;
    if (report.samples > 1 && value >= report.least_determinant) return;
    report.least_determinant = value;
    report.where = point;
  }
};

void look_at_grid(Judge& judge, const Bounds& region, double cell, int dimension) {
  const Vec3 size = region.size();
  int counts[3];
  for (int axis = 0; axis < 3; ++axis)
    counts[axis] = axis < dimension ? static_cast<int>(std::ceil(size[axis] / cell - 1e-9)) + 1 : 1;
  for (int i = 0; i < counts[0]; ++i)
    for (int j = 0; j < counts[1]; ++j)
      for (int k = 0; k < counts[2]; ++k) {
        const int index[3] = {i, j, k};
        Vec3 point = region.lower;
        for (int axis = 0; axis < dimension; ++axis)
          if (counts[axis] > 1) point[axis] += size[axis] * index[axis] / (counts[axis] - 1);
        judge.look(point);
      }
}

bool contains(const Bounds& region, const Vec3& p, int dimension) {
  for (int axis = 0; axis < dimension; ++axis)
    if (p[axis] < region.lower[axis] || p[axis] > region.upper[axis]) return false;
  return true;
}

// A thin plate in space has a cone at every landmark: its one-sided Jacobians, from eight or four sides each.
void look_around_landmarks(Judge& judge, const Bounds& region, double cell, int dimension) {
  if (judge.map.steps().empty() || judge.map.steps().front().identity()) return;
  const SplineCoefficients& s = judge.map.steps().front().displacement().coefficients();
  for (int i = 0; i < s.centres; ++i) {
    const Vec3 landmark = Vec3(s.x[i], s.y[i], s.z[i]) / s.scale + s.centre;
    if (!contains(region, landmark, dimension)) continue;
    for (double radius : {1e-4 * cell, 0.1 * cell})
      for (int corner = 0; corner < (dimension == 2 ? 4 : 8); ++corner) {
        const Vec3 side(corner & 1 ? 1 : -1, corner & 2 ? 1 : -1, dimension == 2 ? 0 : corner & 4 ? 1 : -1);
        judge.look(landmark + radius * side.normalized());
      }
  }
}

// From the worst sample downhill by a shrinking star.
void look_downhill(Judge& judge, const Bounds& region, double cell, int dimension) {
  for (double step = 0.5 * cell; step > 0.01 * cell;) {
    const double before = judge.report.least_determinant;
    const Vec3 at = judge.report.where;
    for (int axis = 0; axis < dimension; ++axis)
      for (double sign : {-1.0, 1.0})
        if (const Vec3 next = at + sign * step * Vec3::Unit(axis); contains(region, next, dimension))
          judge.look(next);
    if (judge.report.least_determinant >= before) step /= 2;
  }
}

double largest_miss(const WarpSequence& map, std::span<const Vec3> source, std::span<const Vec3> target) {
  double out = 0;
  for (size_t i = 0; i < source.size(); ++i)
    out = std::max(out, (map(source[i]) - target[i]).norm());
  return out;
}

// Each step carries the landmarks one part of their straight way.
WarpSequence walk(std::span<const Vec3> source, std::span<const Vec3> target, int steps,
                  const WarpOptions& options) {
  std::vector<Warp> warps;
  std::vector<Vec3> from(source.begin(), source.end());
  for (int k = 1; k <= steps; ++k) {
    std::vector<Vec3> to(source.size());
    for (size_t i = 0; i < to.size(); ++i)
      to[i] = source[i] + (target[i] - source[i]) * k / steps;
    warps.push_back(fit_warp(from, to, options));
    from = std::move(to);
  }
  return WarpSequence(std::move(warps));
}

UnfoldedResult judged(WarpSequence map, std::span<const Vec3> source, std::span<const Vec3> target,
                      const Bounds& region, const FoldOptions& options) {
  UnfoldedResult out;
  out.report = check_folds(map, region, options);
  out.largest_miss = largest_miss(map, source, target);
  out.map = std::move(map);
  return out;
}

UnfoldedResult smoothed(std::span<const Vec3> source, std::span<const Vec3> target, const Bounds& region,
                        WarpOptions warp, const FoldOptions& options) {
  const double extent = bounds(std::vector<Vec3>(source.begin(), source.end())).size().norm();
  const double unit = std::pow(extent, warp.exponent);
  const auto at = [&](double exponent) {
    warp.lambda = unit * std::pow(10.0, exponent);
    UnfoldedResult out =
        judged(WarpSequence({fit_warp(source, target, warp)}), source, target, region, options);
    out.lambda = warp.lambda;
    return out;
  };
  double low = -9, high = 4;
  UnfoldedResult best = at(high);
  if (!best.report.sound())
    throw Error(
        "warp: it folds over even when smoothed to an affine map: the landmarks are mirrored or their "
        "pairs are mixed up");
  for (int i = 0; i < 9; ++i) {
    const double middle = 0.5 * (low + high);
    UnfoldedResult tried = at(middle);
    if (tried.report.sound()) {
      best = std::move(tried);
      high = middle;
    } else {
      low = middle;
    }
  }
  return best;
}

}  // namespace

Vec3 WarpSequence::operator()(const Vec3& point) const {
  Vec3 out = point;
  for (const Warp& step : steps_)
    out = step(out);
  return out;
}

std::vector<Vec3> WarpSequence::operator()(std::span<const Vec3> points) const {
  std::vector<Vec3> out(points.begin(), points.end());
  for (const Warp& step : steps_)
    out = step(std::span<const Vec3>(out));
  return out;
}

TriangleMesh WarpSequence::operator()(const TriangleMesh& mesh) const {
  return {(*this)(std::span<const Vec3>(mesh.vertices)), mesh.triangles};
}

Mat3 WarpSequence::jacobian(const Vec3& point) const {
  Mat3 out = Mat3::Identity();
  Vec3 at = point;
  for (const Warp& step : steps_) {
    out = step.jacobian(at) * out;
    at = step(at);
  }
  return out;
}

FoldReport check_folds(const WarpSequence& map, const Bounds& region, const FoldOptions& options) {
  const int dimension = map.steps().empty() ? 3 : map.steps().front().dimension();
  const Vec3 size = region.size();
  if (options.resolution < 2 || !(size.head(dimension).maxCoeff() > 0) ||
      !(size.head(dimension).minCoeff() >= 0) || !size.head(dimension).allFinite())
    throw Error("fold check: give a region with an extent and a resolution of at least 2");
  const double cell = size.head(dimension).maxCoeff() / (options.resolution - 1);
  Judge judge{map, options, {}};
  look_at_grid(judge, region, cell, dimension);
  look_around_landmarks(judge, region, cell, dimension);
  look_downhill(judge, region, cell, dimension);
  return judge.report;
}

FoldReport check_folds(const Warp& map, const Bounds& region, const FoldOptions& options) {
  return check_folds(WarpSequence({map}), region, options);
}

UnfoldedResult fit_unfolded(std::span<const Vec3> source, std::span<const Vec3> target, const Bounds& region,
                            FoldRemedy remedy, const WarpOptions& warp, const FoldOptions& options) {
  UnfoldedResult plain =
      judged(WarpSequence({fit_warp(source, target, warp)}), source, target, region, options);
  plain.lambda = warp.lambda;
  if (plain.report.sound()) return plain;
  if (remedy == FoldRemedy::smooth) return smoothed(source, target, region, warp, options);
  for (int steps = 2; steps <= 64; steps *= 2) {
    UnfoldedResult tried = judged(walk(source, target, steps, warp), source, target, region, options);
    tried.lambda = warp.lambda;
    if (tried.report.sound()) return tried;
  }
  throw Error(
      "warp: it folds over even in 64 steps: landmarks cross or are mirrored; smooth, or check the pairs");
}

}  // namespace fascia::splines
