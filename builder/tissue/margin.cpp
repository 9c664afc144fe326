#include "builder/tissue/margin.h"

#include <algorithm>
#include <cmath>

namespace fascia::tissue {

std::vector<MarginPlace> margin_places(const FaceRegion& region, Opening opening) {
  const std::vector<double>& distance = region.opening_distance[static_cast<size_t>(opening)];
  const auto on_edge = [&](int v) {
    return region.outer[static_cast<size_t>(v)] && distance[static_cast<size_t>(v)] <= 0.0;
  };
  std::vector<MarginPlace> places;
  if (distance.empty()) return places;
  // An edge of the mesh belongs to the margin when the triangle on one of its sides is lining's.
  for (const fascia::Triangle& t : region.mesh.triangles)
    for (size_t e = 0; e < 3; ++e) {
      const int a = t[e], b = t[(e + 1) % 3];
      if (!on_edge(a) || !on_edge(b) || region.outer[static_cast<size_t>(t[(e + 2) % 3])]) continue;
      const Vec3 &p = region.mesh.vertices[static_cast<size_t>(a)],
                 &q = region.mesh.vertices[static_cast<size_t>(b)];
      const int steps = std::clamp(static_cast<int>((q - p).norm() / 2.5e-4), 1, 40);
      for (int k = 0; k < steps; ++k) {
        const double share = (k + 0.5) / steps;
        places.push_back({(1.0 - share) * p + share * q, share < 0.5 ? a : b});
      }
    }
  return places;
}

Eigen::Vector2d Margin::at(double place) const {
  constexpr double width = 0.05;
  double nearest = 1e9, weight = 0.0;
  for (const auto& [there, value] : samples_)
    nearest = std::min(nearest, std::abs(there - place));
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  for (const auto& [there, value] : samples_) {
    const double d = there - place, w = std::exp((nearest * nearest - d * d) / (width * width));
    sum += w * value;
    weight += w;
  }
  return weight > 0.0 ? Eigen::Vector2d(sum / weight) : sum;
}

}  // namespace fascia::tissue
