#pragma once

#include <optional>
#include <vector>

#include "geometry/mesh.h"

namespace fascia::prepare {

/// Tells upper from lower teeth by where they stand: single teeth, halves of rows, whole rows, or jaws with
/// their gums. Neighbours at the same height are of one row, and of pieces one above the other the higher is
/// of the upper row. So the plane of occlusion may slope, tilt and curve as it does in people.
///
/// `pieces` are the bounds of the connected pieces, metres, rig frame (+Y up). Returns for each whether it is
/// of the lower row; nothing when none stands above another, for then they are all of one row.
std::optional<std::vector<bool>> lower_row(const std::vector<Bounds>& pieces);

}  // namespace fascia::prepare
