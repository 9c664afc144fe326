#pragma once

#include <string>
#include <vector>

#include "bench/expressions/sculpted_head.h"

namespace fascia::bench {

/// Prints how far each shape of `table` goes at weights of 0.1, 0.25, 0.5 and 0.75: the share of the pose at
/// 1 along that pose, <u(w), u(1)> / <u(1), u(1)>, mean over `heads`; and by weight the mean and the largest
/// distance from w. Captured weights mean a share of the shape, so that w itself is right.
void run_response(const std::vector<SculptedHead>& heads, const anatomy::ExpressionSet& table,
                  const std::string& level, int threads);

}  // namespace fascia::bench
