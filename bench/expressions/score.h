#pragma once

#include <Eigen/Core>
#include <vector>

#include "geometry/mesh.h"

namespace fascia::bench {

/// How much of a known shape a simulated one explains.
struct Score {
  double explained = 0.0;   ///< 1 - sum |u - v|^2 / sum |v|^2
  double error_mm = 0.0;    ///< mean distance left over vertices that should move more than 0.5 mm
  double best_scale = 0.0;  ///< the factor of the simulated shape that would serve best
  double at_best_scale =
      0.0;         ///< the share explained at it: low is a wrong direction, high a wrong amplitude
  int turned = 0;  ///< triangles that the simulation turns over and the known shape does not
};

/// `simulated` and `truth`: 3 x #vertices, metres from `rest`. Triangles by vertex.
Score score(const std::vector<Vec3>& rest, const std::vector<Triangle>& triangles,
            const Eigen::VectorXd& simulated, const Eigen::VectorXd& truth);

}  // namespace fascia::bench
