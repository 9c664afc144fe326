#include "builder/splines/crease.h"

#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "geometry/error.h"

namespace fascia::splines {
namespace {

struct Grid {
  Vec3 lower, cell;
  std::array<int, 3> counts;
  Vec3 point(int i, int j, int k) const { return lower + Vec3(i, j, k).cwiseProduct(cell); }
  size_t index(int i, int j, int k) const { return (static_cast<size_t>(k) * counts[1] + j) * counts[0] + i; }
};

Grid make_grid(const Bounds& region, int resolution, int dimension) {
  const Vec3 size = region.size();
  const double step = size.head(dimension).maxCoeff() / (resolution - 1);
  Grid grid{region.lower, Vec3::Zero(), {1, 1, 1}};
  for (int axis = 0; axis < dimension; ++axis) {
    grid.counts[axis] = std::max(1, static_cast<int>(std::ceil(size[axis] / step - 1e-9))) + 1;
    grid.cell[axis] = size[axis] / (grid.counts[axis] - 1);
  }
  return grid;
}

// The map's most pressed (sign -1) or most stretched (+1) direction at a point.
Crease strain(const Warp& map, const Vec3& point, int sign) {
  const int d = map.dimension();
  const Eigen::MatrixXd J = map.jacobian(point).topLeftCorner(d, d);
  const Eigen::JacobiSVD<Eigen::MatrixXd> svd(J, Eigen::ComputeFullU | Eigen::ComputeFullV);
  const int at = sign > 0 ? 0 : d - 1;
  Crease out;
  out.point = point;
  out.direction.head(d) = svd.matrixV().col(at);
  out.image.head(d) = svd.matrixU().col(at);
  out.stretch = svd.singularValues()[at];
  return out;
}

double strength(const Crease& crease, int sign) {
  return sign * std::log(std::max(crease.stretch, 1e-12));
}

Crease refined(const Warp& map, Crease at, const Grid& grid, int sign) {
  for (double step = 0.5; step > 0.01;) {
    Crease best = at;
    for (int axis = 0; axis < map.dimension(); ++axis)
      for (double side : {-step, step}) {
        const Crease next = strain(map, at.point + side * grid.cell[axis] * Vec3::Unit(axis), sign);
        if (strength(next, sign) > strength(best, sign)) best = next;
      }
    if (best.point == at.point) step /= 2;
    at = best;
  }
  return at;
}

bool is_extreme(const Grid& grid, const std::vector<double>& values, int i, int j, int k, bool interior) {
  const std::array<int, 3> at = {i, j, k};
  for (int axis = 0; axis < 3; ++axis)
    if (interior && grid.counts[axis] > 1 && (at[axis] == 0 || at[axis] == grid.counts[axis] - 1))
      return false;
  const size_t self = grid.index(i, j, k);
  for (int c = std::max(0, k - 1); c <= std::min(grid.counts[2] - 1, k + 1); ++c)
    for (int b = std::max(0, j - 1); b <= std::min(grid.counts[1] - 1, j + 1); ++b)
      for (int a = std::max(0, i - 1); a <= std::min(grid.counts[0] - 1, i + 1); ++a) {
        const size_t other = grid.index(a, b, c);
        // Of equals the first counts.
        if (values[other] > values[self] || (values[other] == values[self] && other < self)) return false;
      }
  return true;
}

}  // namespace

std::vector<Crease> find_creases(const Warp& map, const Bounds& region, const CreaseOptions& options) {
  const int dimension = map.dimension();
  if (options.resolution < 3 || !(region.size().head(dimension).minCoeff() > 0))
    throw Error("creases: give a region with an extent and a resolution of at least 3");
  const Grid grid = make_grid(region, options.resolution, dimension);
  std::vector<Crease> out;
  for (int sign : {-1, 1}) {
    std::vector<double> values;
    for (int k = 0; k < grid.counts[2]; ++k)
      for (int j = 0; j < grid.counts[1]; ++j)
        for (int i = 0; i < grid.counts[0]; ++i)
          values.push_back(strength(strain(map, grid.point(i, j, k), sign), sign));
    for (int k = 0; k < grid.counts[2]; ++k)
      for (int j = 0; j < grid.counts[1]; ++j)
        for (int i = 0; i < grid.counts[0]; ++i) {
          if (values[grid.index(i, j, k)] < options.least) continue;
          if (is_extreme(grid, values, i, j, k, options.interior))
            out.push_back(refined(map, strain(map, grid.point(i, j, k), sign), grid, sign));
        }
  }
  std::stable_sort(out.begin(), out.end(), [](const Crease& a, const Crease& b) {
    return std::abs(std::log(std::max(a.stretch, 1e-12))) > std::abs(std::log(std::max(b.stretch, 1e-12)));
  });
  return out;
}

}  // namespace fascia::splines
