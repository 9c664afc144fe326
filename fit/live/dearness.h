#pragma once

#include <vector>

#include "rig/model/rig.h"

namespace fascia::fit {

/// How much more each channel costs in a fit than one that the expression tables use to the full: 1 to 4.
std::vector<double> dearness_of(const rig::Actuation& actuation);

}  // namespace fascia::fit
