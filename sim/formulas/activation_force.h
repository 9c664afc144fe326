// How hard a muscle pulls at an activation, written once for doubles and for lanes (numbers.h).

#pragma once

#include "sim/formulas/numbers.h"

namespace fascia::sim::formulas {

/// Of a small activation's force over the activation. What a face shows of a force levels off, for the tissue
/// stiffens and a shorter muscle pulls less; with so much less force at first, skin moves about as far as the
/// activation says: an activation is a share of the way, not of the force, and 1 is the whole of both.
constexpr double first_force = 0.45;

/// Share of a muscle's whole force at `activation` from 0 on: 0 at 0, 1 at 1, rising throughout.
template <class N>
FASCIA_INLINE N activation_force(const N& activation) {
  return activation * (first_force + (1.0 - first_force) * activation);
}

/// Its derivative.
inline double activation_force_slope(double activation) {
  return first_force + 2.0 * (1.0 - first_force) * activation;
}

}  // namespace fascia::sim::formulas
