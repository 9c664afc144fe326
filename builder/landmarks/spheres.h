#pragma once

#include <vector>

#include "builder/landmarks/samples.h"

namespace fascia::landmarks {

/// Least-squares sphere through `points` (Pratt's linear form, centred); radius 0 when there are fewer than
/// four.
Ball fit_ball(const std::vector<Vec3>& points);

/// Round lumps of a surface that may be a head, best first: spheres that the samples follow, normals outward,
/// over much of their directions. At most `count`; the sphere through all samples is always the last.
std::vector<Ball> round_lumps(const Samples& samples, int count);

}  // namespace fascia::landmarks
