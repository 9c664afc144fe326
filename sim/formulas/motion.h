// How bones and actuators turn places, written once for doubles and for lanes (numbers.h).

#pragma once

#include "sim/formulas/numbers.h"

namespace fascia::sim::formulas {

/// What turning about a unit axis adds to an arm (Rodrigues); the versine is 1 - cosine.
template <class N>
FASCIA_INLINE Three<N> turned(const Three<N>& axis, const N& sine, const N& versine, const Three<N>& arm) {
  const Three<N> across = cross(axis, arm);
  return sine * across + versine * cross(axis, across);
}

/// What the jaw's rotation adds to an arm from its joint: by `open` radians about `lateral`, then by
/// `sideways` radians about `up`. See sim::Jaw.
template <class N>
FASCIA_INLINE Three<N> jaw_turn(const Three<N>& lateral, const Three<N>& up, const N& open, const N& sideways,
                                const Three<N>& arm) {
  N sine, versine;
  sine_and_versine(open, sine, versine);
  const Three<N> first = turned(lateral, sine, versine, arm);
  sine_and_versine(sideways, sine, versine);
  return first + turned(up, sine, versine, arm + first);
}

/// Force with which an actuator pulls a node that it turns about an axis: `stiffness` newton per metre of the
/// way that turning takes the node's `arm`. The angle in radians is `forward` at value 1, `backward` at -1.
template <class N>
FASCIA_INLINE Three<N> rotary_pull(const N& stiffness, const N& value, const N& forward, const N& backward,
                                   const Three<N>& axis, const Three<N>& arm) {
  const N angle = where_below(value, like(value, 0.0), -(value * backward), value * forward);
  N sine, versine;
  sine_and_versine(angle, sine, versine);
  return stiffness * turned(axis, sine, versine, arm);
}

}  // namespace fascia::sim::formulas
