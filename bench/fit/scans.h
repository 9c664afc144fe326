#pragma once

#include <set>

#include "bench/expressions/sculpted_head.h"
#include "fit/fit.h"

namespace fascia::bench {

/// Prints what is found of the head's ARKit expressions, at 0.8 (or `only` some of them), from scans of
/// another meshing of the posed skin: the share explained of the skin's true motion, and of what is missed
/// the parts across the surface and along it.
void find_scans(const SculptedHead& head, const std::string& level, const std::set<std::string>& only,
                const fit::FitOptions& options);

}  // namespace fascia::bench
