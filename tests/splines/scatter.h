#pragma once

#include <random>
#include <vector>

#include "geometry/mesh.h"

namespace fascia::splines {

/// Points of the cube [-1, 1]^3, or of its middle plane.
inline std::vector<Vec3> scattered(int count, unsigned seed, bool flat = false) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  std::vector<Vec3> out;
  for (int i = 0; i < count; ++i) {
    const double x = uniform(random), y = uniform(random), z = uniform(random);
    out.emplace_back(x, y, flat ? 0 : z);
  }
  return out;
}

}  // namespace fascia::splines
