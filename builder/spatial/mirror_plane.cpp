#include "builder/spatial/mirror_plane.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace fascia::spatial {
namespace {

/// A place on the surface and which way the surface faces there.
struct Place {
  Vec3 position, normal;
};

/// A place's image beside the surface.
struct Pair {
  Vec3 from, image, normal;  // normal: of the surface, where it is nearest to the image
  double off = 0.0;          // along the normal
  double apart = 0.0;
};

std::vector<Place> placed(const SurfaceQuery& surface, const std::vector<Vec3>& places, double within) {
  std::vector<Place> list;
  for (const Vec3& p : places)
    if (const ClosestPoint here = surface.nearest_place(p, within); here.found())
      list.push_back({p, triangle_normal(surface.mesh(), here.surface.triangle)});
  return list;
}

std::vector<Pair> pairs_of(const SurfaceQuery& surface, const std::vector<Place>& places,
                           const MirrorPlane& plane, double within) {
  std::vector<Pair> pairs;
  for (const Place& place : places) {
    const Vec3 image = plane.image(place.position);
    const ClosestPoint there = surface.nearest_place(image, within);
    if (!there.found()) continue;
    const Vec3 normal = triangle_normal(surface.mesh(), there.surface.triangle);
    if (plane.turned(place.normal).dot(normal) < 0.2) continue;
    pairs.push_back({place.position, image, normal, normal.dot(image - there.position), there.distance});
  }
  return pairs;
}

/// Tukey's biweight: where residuals stop to count, by their median.
double cut_off(const std::vector<Pair>& pairs, double within) {
  std::vector<double> sizes;
  for (const Pair& pair : pairs)
    sizes.push_back(std::abs(pair.off));
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  constexpr double tuning = 4.685 * 1.4826;
  return std::max(tuning * *middle, 0.02 * within);
}

/// One step of Gauss and Newton over the plane's turn about two axes in it and its shift along the normal.
/// Returns how far it moved what lies a unit from the middle of the pairs.
double improve(const std::vector<Pair>& pairs, double within, MirrorPlane& plane) {
  Vec3 middle = Vec3::Zero();
  for (const Pair& pair : pairs)
    middle += pair.from / static_cast<double>(pairs.size());
  const Vec3 n = plane.normal, foot = plane.foot(middle);
  const Vec3 u = (n.cross(std::abs(n.y()) < 0.7 ? Vec3::UnitY() : Vec3::UnitZ())).normalized(),
             v = n.cross(u);
  const double cut = cut_off(pairs, within);
  double size = 0.0;
  for (const Pair& pair : pairs)
    size = std::max(size, (pair.from - foot).norm());
  Eigen::Matrix3d normal_matrix = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  double weights = 0.0;
  for (const Pair& pair : pairs) {
    const double share = pair.off / cut;
    if (std::abs(share) >= 1.0) continue;
    const double weight = (1.0 - share * share) * (1.0 - share * share);
    const Vec3 arm = pair.from - foot;
    const double aside = n.dot(arm), m_n = pair.normal.dot(n);
    const Eigen::Vector3d slope(-2.0 * (u.dot(arm) * m_n + aside * pair.normal.dot(u)) / size,
                                -2.0 * (v.dot(arm) * m_n + aside * pair.normal.dot(v)) / size, 2.0 * m_n);
    normal_matrix += weight * slope * slope.transpose();
    right -= weight * pair.off * slope;
    weights += weight;
  }
  if (!(weights > 0.0)) return 0.0;
  constexpr double held = 1e-4;  // of a pair seen squarely, a pair: what nothing says stays
  normal_matrix.diagonal().array() += held * weights;
  const Eigen::Vector3d step = normal_matrix.ldlt().solve(right);
  if (!step.allFinite()) return 0.0;
  plane.normal = (n + (step[0] * u + step[1] * v) / size).normalized();
  plane.point = foot + step[2] * n;
  return step.norm();
}

}  // namespace

std::optional<MirrorPlane> plane_between(const std::vector<std::pair<Vec3, Vec3>>& pairs) {
  Vec3 across = Vec3::Zero(), middle = Vec3::Zero();
  for (const auto& [left, right] : pairs) {
    across += left - right;
    middle += 0.5 * (left + right);
  }
  if (!(across.norm() > 0.0)) return {};
  return MirrorPlane{middle / static_cast<double>(pairs.size()), across.normalized()};
}

double MirrorFit::most_apart() const {
  if (apart.empty()) return std::numeric_limits<double>::infinity();
  std::vector<double> sorted = apart;
  const auto most = sorted.begin() + static_cast<std::ptrdiff_t>(9 * sorted.size() / 10);
  std::nth_element(sorted.begin(), most, sorted.end());
  return *most;
}

MirrorFit fit_mirror_plane(const SurfaceQuery& surface, const std::vector<Vec3>& places,
                           const MirrorPlane& start, double within) {
  constexpr int rounds = 20;
  constexpr size_t least = 8;
  constexpr double still = 1e-4;  // of `within`
  MirrorFit fit{start, {}};
  const std::vector<Place> known = placed(surface, places, within);
  std::vector<Pair> pairs = pairs_of(surface, known, fit.plane, within);
  for (int round = 0; round < rounds && pairs.size() >= least; ++round) {
    const double moved = improve(pairs, within, fit.plane);
    pairs = pairs_of(surface, known, fit.plane, within);
    if (moved < still * within) break;
  }
  for (const Pair& pair : pairs)
    fit.apart.push_back(pair.apart);
  return fit;
}

}  // namespace fascia::spatial
