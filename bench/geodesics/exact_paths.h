#pragma once

#include <vector>

#include "bench/geodesics/head_surface.h"

namespace fascia::bench {

struct ExactPath {
  double length = 0.0;   ///< metres
  double seconds = 0.0;  ///< of one query: propagation from `from` and the distance to `to`
  std::vector<Vec3> positions;
};

/// CGAL's shortest paths on the polyhedron (Xin & Wang's improved Chen–Han), one source a pair.
std::vector<ExactPath> exact_paths(const TriangleMesh& mesh, const std::vector<PointPair>& pairs);

}  // namespace fascia::bench
