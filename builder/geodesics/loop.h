#pragma once

#include "builder/geodesics/path.h"

namespace fascia::geodesics {

struct LoopOptions {
  PathOptions path;
  /// Rounds of straightening from alternating anchors; stops when a round gains less than
  /// `gain_tolerance` of the length.
  int maximum_rounds = 500;
  double gain_tolerance = 1e-13;
};

struct LoopResult {
  /// The closed geodesic; its last point is its first.
  Path path;
  int rounds = 0;
  /// The loop has no closed geodesic in its class: it pulled together to a point. `path` is that point.
  bool contracted = false;
};

/// The closed geodesic that the polygon through `corners` (at least 3, joined in order and back to the
/// first) pulls taut to without leaving its class. Each round opens the loop at one of its points and
/// straightens it with that point fixed; the anchor then moves to the far side.
/// Throws `Error` for fewer than 3 corners or corners on unconnected parts.
LoopResult tighten_loop(const Surface& surface, const std::vector<SurfacePoint>& corners,
                        const LoopOptions& options = {});

}  // namespace fascia::geodesics
