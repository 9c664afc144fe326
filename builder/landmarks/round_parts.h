#pragma once

#include <vector>

#include "builder/landmarks/samples.h"

namespace fascia::landmarks {

/// The parts of `mesh` that are balls, or caps of balls as eyes often are. Parts hang together by edges: an
/// eyeball that touches its lids in a vertex is a part of its own.
std::vector<Ball> round_parts(const TriangleMesh& mesh);

/// The holes of `mesh` that are about as wide as high, as empty sockets are: middle and mean radius of each.
std::vector<Ball> round_holes(const TriangleMesh& mesh);

}  // namespace fascia::landmarks
