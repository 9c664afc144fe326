#pragma once

#include <string>

#include "anatomy/anatomy.h"

namespace fascia::bench {

/// Prints how far the landmarks found in changed copies of the head file `path` lie from those found in
/// itself, mean and largest, in millimetres of the rig frame: turned, mirrored, in another order, subdivided,
/// with half the triangles; then those found when some of them are given, when the skin's mesh is named and
/// when the up axis is told.
void measure_same_head(const std::string& path, const anatomy::GenericAnatomy& anatomy);

}  // namespace fascia::bench
