#pragma once

#include "bench/expressions/sculpted_head.h"
#include "fit/fit.h"

namespace fascia::bench {

/// Prints how well poses of five random muscles (0.3 to 0.9 of their range) of `head` are found again,
/// `poses` of them: from clean targets, and from targets with half a millimetre of noise; and which
/// activations are off.
void find_random_poses(const SculptedHead& head, const std::string& level, int poses,
                       const fit::FitOptions& options);

}  // namespace fascia::bench
