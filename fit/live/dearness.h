#pragma once

#include <vector>

#include "rig/model/rig.h"

namespace fascia::fit {

/// Penalty factor of each channel in a fit, 1 to 4: 1 for channels that the expression tables use fully.
std::vector<double> dearness_of(const rig::Actuation& actuation);

}  // namespace fascia::fit
