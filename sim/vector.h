#pragma once

#include <Eigen/Core>
#include <vector>

namespace fascia::sim {

/// The solver works in double precision inside; positions and stiffnesses come and go as float.
using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using Vec3f = Eigen::Vector3f;
using Positions = std::vector<Vec3>;

}  // namespace fascia::sim
