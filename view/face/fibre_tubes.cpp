#include "view/face/fibre_tubes.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace fascia::view {

namespace {

/// Half the usual distance from a fibre's middle to the next fibre.
double radius_of(const std::vector<std::vector<Vec3>>& fibres, const FibreTubeOptions& options) {
  std::vector<double> gaps;
  for (size_t f = 0; f < fibres.size(); ++f) {
    if (fibres[f].empty()) continue;
    const Vec3& middle = fibres[f][fibres[f].size() / 2];
    double nearest = 1.0;
    for (size_t other = 0; other < fibres.size(); ++other)
      if (other != f)
        for (const Vec3& p : fibres[other])
          nearest = std::min(nearest, (p - middle).norm());
    gaps.push_back(nearest);
  }
  if (gaps.empty()) return options.thinnest;
  std::nth_element(gaps.begin(), gaps.begin() + static_cast<std::ptrdiff_t>(gaps.size() / 2), gaps.end());
  return std::clamp(options.share * gaps[gaps.size() / 2], options.thinnest, options.thickest);
}

bool is_closed(const std::vector<Vec3>& line) {
  return (line.front() - line.back()).norm() < 1e-5;
}

/// The same line with points between, where it has too few to tell its belly from its ends.
std::vector<Vec3> with_belly(const std::vector<Vec3>& line) {
  const size_t pieces = line.size() >= 6 ? 1 : (8 + line.size() - 2) / (line.size() - 1);
  std::vector<Vec3> finer = {line.front()};
  for (size_t i = 1; i < line.size(); ++i)
    for (size_t k = 1; k <= pieces; ++k)
      finer.push_back(line[i - 1] + (double(k) / double(pieces)) * (line[i] - line[i - 1]));
  return finer;
}

/// Shares of the whole length, 0 at the first point.
std::vector<double> shares_along(const std::vector<Vec3>& line) {
  std::vector<double> along = {0.0};
  for (size_t i = 1; i < line.size(); ++i)
    along.push_back(along.back() + (line[i] - line[i - 1]).norm());
  const double length = std::max(along.back(), 1e-12);
  for (double& s : along)
    s /= length;
  return along;
}

}  // namespace

void add_fibre_tubes(const std::vector<std::vector<Vec3>>& fibres, const FibreTubeOptions& options,
                     DrawSurface& surface) {
  const double radius = radius_of(fibres, options);
  for (const std::vector<Vec3>& fibre : fibres) {
    if (fibre.size() < 2) continue;
    const std::vector<Vec3> line = options.has_tendons ? with_belly(fibre) : fibre;
    const std::vector<double> along = shares_along(line);
    const bool has_ends = options.has_tendons && !is_closed(line);
    const int first = static_cast<int>(surface.positions.size()), sides = options.sides;
    Vec3 side = (line[1] - line[0]).unitOrthogonal();
    for (size_t i = 0; i < line.size(); ++i) {
      const Vec3 direction = (line[std::min(i + 1, line.size() - 1)] - line[i ? i - 1 : 0]).normalized();
      // Carried along without twist.
      side -= side.dot(direction) * direction;
      side = side.norm() > 1e-9 ? Vec3(side.normalized()) : Vec3(direction.unitOrthogonal());
      const Vec3 other = direction.cross(side);
      const double from_end = std::min(along[i], 1.0 - along[i]);
      const double belly = has_ends ? std::clamp(from_end / 0.16, 0.0, 1.0) : 1.0;
      const double thickness = radius * (has_ends ? 0.45 + 0.55 * std::sqrt(belly) : 1.0);
      const double flesh = has_ends ? std::clamp((from_end - 0.015) / 0.10, 0.0, 1.0) : 1.0;
      for (int k = 0; k < sides; ++k) {
        const double turn = 2.0 * EIGEN_PI * k / sides;
        const Vec3 out = std::cos(turn) * side + std::sin(turn) * other;
        surface.positions.push_back(line[i] + thickness * out);
        surface.normals.push_back(out);
        surface.vertex_colours.push_back(options.tendon + flesh * (options.flesh - options.tendon));
      }
      if (i == 0) continue;
      const int here = first + static_cast<int>(i) * sides, before = here - sides;
      for (int k = 0; k < sides; ++k) {
        const int next = (k + 1) % sides;
        surface.triangles.push_back({before + k, before + next, here + next});
        surface.triangles.push_back({before + k, here + next, here + k});
      }
    }
  }
}

}  // namespace fascia::view
