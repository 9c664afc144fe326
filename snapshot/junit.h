#pragma once

#include <string>

#include "snapshot/compare.h"

namespace fascia::snapshot {

/// A comparison as JUnit XML, as continuous integration reads it: a test case for each state, with a failure
/// that lists the regions that moved. `suite` names the whole; `tolerance_mm` is what `compare` was given.
std::string junit(const Snapshot& then, const Comparison& comparison, const std::string& suite,
                  double tolerance_mm);

/// "mouth_corner_left: 0.214 mm on average, 0.431 mm at vertex 1204 of mesh 0; 0.03 mm allowed".
/// `tolerance_mm` 0: what the region allows.
std::string sentence(const Snapshot& then, const Difference& difference, double tolerance_mm);

}  // namespace fascia::snapshot
