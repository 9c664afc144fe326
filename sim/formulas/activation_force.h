// Muscle force as a function of activation, for doubles and for lanes (numbers.h).

#pragma once

#include "sim/formulas/numbers.h"

namespace fascia::sim::formulas {

/// Fraction of a muscle's maximal force at `activation` >= 0: 0 at 0, 1 at 1, increasing. `initial_slope`, 0
/// to 1, is its slope at zero activation. The displacement saturates with force, because tissue stiffens and
/// a shorter muscle pulls less; with a slope below 1 the displacement is roughly proportional to activation.
template <class N>
FASCIA_INLINE N activation_force(const N& activation, double initial_slope) {
  return activation * (initial_slope + (1.0 - initial_slope) * activation);
}

/// Its derivative.
inline double activation_force_slope(double activation, double initial_slope) {
  return initial_slope + 2.0 * (1.0 - initial_slope) * activation;
}

}  // namespace fascia::sim::formulas
