#pragma once

#include <Eigen/Core>
#include <vector>

#include "sim/formulas/numbers.h"

namespace fascia::sim {

/// The solver works in double precision internally; inputs and outputs are float.
using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using Vec3f = Eigen::Vector3f;
using Positions = std::vector<Vec3>;

/// A vector of Eigen's as one of the formulas', and back.
inline formulas::Three<double> three(const Vec3& v) {
  return {v.x(), v.y(), v.z()};
}
inline Vec3 vec3(const formulas::Three<double>& v) {
  return {v.x, v.y, v.z};
}

}  // namespace fascia::sim
