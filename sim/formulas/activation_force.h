// Muscle force as a function of activation, for doubles and for lanes (numbers.h).

#pragma once

#include "sim/formulas/numbers.h"

namespace fascia::sim::formulas {

/// Slope of the force at zero activation. The displacement saturates with force, because tissue stiffens and
/// a shorter muscle pulls less; with a smaller slope at first, the displacement is roughly proportional to
/// activation.
constexpr double first_force = 0.45;

/// Fraction of a muscle's maximal force at `activation` >= 0: 0 at 0, 1 at 1, increasing.
template <class N>
FASCIA_INLINE N activation_force(const N& activation) {
  return activation * (first_force + (1.0 - first_force) * activation);
}

/// Its derivative.
inline double activation_force_slope(double activation) {
  return first_force + 2.0 * (1.0 - first_force) * activation;
}

}  // namespace fascia::sim::formulas
