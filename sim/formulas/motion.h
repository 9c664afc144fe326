// Rotations of positions by bones and actuators, for doubles and for lanes (numbers.h).

#pragma once

#include "sim/formulas/numbers.h"

namespace fascia::sim::formulas {

/// Displacement of an arm by a rotation about a unit axis (Rodrigues); the versine is 1 - cosine.
template <class N>
FASCIA_INLINE Three<N> turned(const Three<N>& axis, const N& sine, const N& versine, const Three<N>& arm) {
  const Three<N> across = cross(axis, arm);
  return sine * across + versine * cross(axis, across);
}

/// Displacement of an arm from the joint by the jaw's rotation: by `open` radians about `lateral`, then by
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

/// Force of an actuator on a node that it rotates about an axis: `stiffness` newton per metre of the
/// displacement of the node's `arm`. The angle in radians is `forward` at value 1, `backward` at -1.
template <class N>
FASCIA_INLINE Three<N> rotary_pull(const N& stiffness, const N& value, const N& forward, const N& backward,
                                   const Three<N>& axis, const Three<N>& arm) {
  const N angle = where_below(value, like(value, 0.0), -(value * backward), value * forward);
  N sine, versine;
  sine_and_versine(angle, sine, versine);
  return stiffness * turned(axis, sine, versine, arm);
}

}  // namespace fascia::sim::formulas
