#pragma once

#include "tools/anatomy/skull/figures.h"

namespace fascia::skull_maker {

/// One dental row, both sides, in the generic frame: a closed mesh for each tooth, crown and a stub of
/// its root that ends `depth` mm from the tip, lofted through the measured sections and capped with the cusps
/// of its kind.
TriangleMesh dental_row(const std::vector<Tooth>& left, const splines::Warp& to_generic, double depth);

}  // namespace fascia::skull_maker
