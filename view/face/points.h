#pragma once

#include <span>
#include <vector>

#include "geometry/mesh.h"

namespace fascia::view {

/// Points from three numbers each.
inline std::vector<Vec3> points_of(std::span<const float> flat) {
  std::vector<Vec3> points;
  points.reserve(flat.size() / 3);
  for (size_t i = 0; i + 2 < flat.size(); i += 3)
    points.emplace_back(flat[i], flat[i + 1], flat[i + 2]);
  return points;
}

/// The points of some of the parts of a face, one part after the other; `positions` has three numbers for
/// each.
template <class Positions>
std::vector<Vec3> points_of(const Positions& positions, const std::vector<size_t>& parts) {
  std::vector<Vec3> points;
  for (const size_t part : parts) {
    const std::vector<Vec3> own = points_of(std::span<const float>(positions[part]));
    points.insert(points.end(), own.begin(), own.end());
  }
  return points;
}

}  // namespace fascia::view
