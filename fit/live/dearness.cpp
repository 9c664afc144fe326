#include "fit/live/dearness.h"

#include <algorithm>
#include <cmath>

namespace fascia::fit {

std::vector<double> dearness_of(const rig::Actuation& actuation) {
  std::vector<double> usage(actuation.channels.size(), 0.0);
  for (const rig::NamedSet& set : actuation.sets)
    for (size_t e = 0; e < set.weights.size(); ++e) {
      double& most = usage[set.channel_indices[e]];
      most = std::max(most, std::min(1.0, std::abs(static_cast<double>(set.weights[e]))));
    }
  for (double& value : usage)
    value = 1.0 / (0.25 + 0.75 * value);
  return usage;
}

}  // namespace fascia::fit
