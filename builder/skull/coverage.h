#pragma once

#include <array>
#include <vector>

#include "builder/skull/placement.h"
#include "builder/skull/skull.h"

namespace fascia::skull {

/// Which triangles of cranium, mandible and teeth lie under skin that the head has.
struct Coverage {
  std::array<std::vector<bool>, 4> covered;  ///< cranium, mandible, upper teeth, lower teeth
  double uncovered_share = 0;                ///< of the area of all
};

/// A bone point is covered when the generic skin over it, carried by `to_head`, does not arrive beyond the
/// edge of the head's skin. Whole heads, and scans with small gaps, are covered everywhere.
Coverage coverage(const Generic& generic, const Bones& bones, const splines::Warp& to_head,
                  const Exterior& skin);

/// Leaves what is not covered out of the meshes of `out`; a mesh of which less than a tenth would stay is
/// kept.
void trim(const Coverage& coverage, FitResult& out);

}  // namespace fascia::skull
