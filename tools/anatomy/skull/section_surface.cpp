#include "tools/anatomy/skull/section_surface.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nanoflann.hpp>
#include <unordered_map>

#include "builder/splines/polyharmonic.h"
#include "geometry/smoothstep.h"

namespace fascia::skull_maker {
namespace {

struct Cloud {
  const std::vector<OrientedPoint>& points;
  std::size_t kdtree_get_point_count() const { return points.size(); }
  double kdtree_get_pt(std::size_t i, std::size_t axis) const {
    return points[i].position[static_cast<int>(axis)];
  }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};
using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<double, Cloud>, Cloud, 3>;

struct Patch {
  Vec3 centre = Vec3::Zero();
  double radius = 0;
  splines::Spline field;
};

/// The patches, and a grid of cells that tells which of them reach where.
struct Patches {
  std::vector<Patch> patches;
  double cell = 4.0;
  std::unordered_map<long long, std::vector<int>> cells;
  double blend_width = 12.0;

  long long key(const Vec3& point) const {
    long long out = 0;
    for (int axis = 0; axis < 3; ++axis)
      out = out * 4096 + (static_cast<long long>(std::floor(point[axis] / cell)) + 2048);
    return out;
  }

  void index() {
    for (int p = 0; p < static_cast<int>(patches.size()); ++p) {
      const Patch& patch = patches[static_cast<std::size_t>(p)];
      const int reach = static_cast<int>(std::ceil(patch.radius / cell)) + 1;
      const Vec3 base = (patch.centre / cell).array().floor() * cell + 0.5 * cell;
      for (int i = -reach; i <= reach; ++i) {
        for (int j = -reach; j <= reach; ++j) {
          for (int k = -reach; k <= reach; ++k) {
            const Vec3 middle = base + cell * Vec3(i, j, k);
            const Vec3 nearest = patch.centre.cwiseMax(middle - Vec3::Constant(0.5 * cell))
                                     .cwiseMin(middle + Vec3::Constant(0.5 * cell));
            if ((nearest - patch.centre).norm() < patch.radius) cells[key(middle)].push_back(p);
          }
        }
      }
    }
  }

  /// Blended field and gradient at `point`; not a number where no patch reaches.
  double blended(const Vec3& point, Vec3& gradient) const {
    gradient.setZero();
    const auto found = cells.find(key(point));
    double weights = 0;
    double sum = 0;
    Vec3 weights_gradient = Vec3::Zero();
    Vec3 sum_gradient = Vec3::Zero();
    if (found != cells.end()) {
      for (const int p : found->second) {
        const Patch& patch = patches[static_cast<std::size_t>(p)];
        const Vec3 offset = point - patch.centre;
        const double t = offset.norm() / patch.radius;
        if (t >= 1) continue;
        // Wendland's C2 bump (1 - t)^4 (4t + 1); its derivative is -20 t (1 - t)^3.
        const double s = 1 - t;
        const double weight = s * s * s * s * (4 * t + 1);
        const Vec3 weight_gradient = (-20 * s * s * s / (patch.radius * patch.radius)) * offset;
        Vec3 field_gradient;
        const double field = patch.field.value_and_gradient(point, field_gradient);
        weights += weight;
        sum += weight * field;
        weights_gradient += weight_gradient;
        sum_gradient += weight_gradient * field + weight * field_gradient;
      }
    }
    if (weights < 1e-9) return std::numeric_limits<double>::quiet_NaN();
    gradient = (sum_gradient - (sum / weights) * weights_gradient) / weights;
    return sum / weights;
  }

  /// The field of |x|, met smoothly with its mirror image next to the midplane.
  double symmetric(Vec3 point, Vec3* gradient) const {
    const double side = point.x() < 0 ? -1.0 : 1.0;
    point.x() = std::abs(point.x());
    Vec3 own;
    double value = blended(point, own);
    if (point.x() < blend_width) {
      const double t = point.x() / blend_width;
      const double share = 0.5 + 0.5 * smoothstep(t);
      const double share_slope = 3 * t * (1 - t) / blend_width;
      Vec3 other;
      const double mirrored = blended({-point.x(), point.y(), point.z()}, other);
      other.x() = -other.x();
      own = share * own + (1 - share) * other;
      own.x() += share_slope * (value - mirrored);
      value = share * value + (1 - share) * mirrored;
    }
    if (gradient) *gradient = {side * own.x(), own.y(), own.z()};
    return value;
  }
};

Patch fit_patch(const std::vector<OrientedPoint>& points, const Tree& tree, int centre,
                const SectionSurfaceOptions& options) {
  const auto count = std::min(points.size(), static_cast<std::size_t>(options.neighbours));
  std::vector<unsigned> near(count);
  std::vector<double> squared(count);
  Patch patch;
  patch.centre = points[static_cast<std::size_t>(centre)].position;
  tree.knnSearch(patch.centre.data(), count, near.data(), squared.data());
  patch.radius = 1.05 * std::sqrt(squared.back());
  std::sort(near.begin(), near.end());
  splines::Sites sites;
  Eigen::VectorXd data = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(4 * count));
  for (std::size_t i = 0; i < count; ++i) {
    sites.points.push_back(points[near[i]].position);
    sites.weights.push_back(1.0);
    sites.add_gradient(points[near[i]].position);
    data.segment<3>(static_cast<Eigen::Index>(count + 3 * i)) = points[near[i]].normal;
  }
  sites.derivative_weights.assign(3 * count, options.normal_weight);
  splines::SplineOptions spline;
  spline.exponent = 3;
  spline.lambda = options.smoothing;
  patch.field = splines::fit(sites, data, spline);
  return patch;
}

}  // namespace

smas::ImplicitFunction section_surface(const std::vector<OrientedPoint>& left,
                                       const SectionSurfaceOptions& options) {
  std::vector<OrientedPoint> points = left;
  const Vec3 mirror(-1, 1, 1);
  for (const OrientedPoint& point : left) {
    if (point.position.x() > 0 && point.position.x() < 40) {
      points.push_back({point.position.cwiseProduct(mirror), point.normal.cwiseProduct(mirror)});
    }
  }
  const Cloud cloud{points};
  const Tree tree(3, cloud, nanoflann::KDTreeSingleIndexAdaptorParams(10));
  auto patches = std::make_shared<Patches>();
  patches->blend_width = options.blend_width;
  std::vector<bool> covered(points.size(), false);
  for (int i = 0; i < static_cast<int>(points.size()); ++i) {
    if (covered[static_cast<std::size_t>(i)] || points[static_cast<std::size_t>(i)].position.x() < -20)
      continue;
    const Patch patch = fit_patch(points, tree, i, options);
    for (std::size_t j = 0; j < points.size(); ++j) {
      if ((points[j].position - patch.centre).norm() < options.covered * patch.radius) covered[j] = true;
    }
    patches->patches.push_back(patch);
  }
  patches->index();
  return [patches](const Vec3& point, Vec3* gradient) { return patches->symmetric(point, gradient); };
}

}  // namespace fascia::skull_maker
