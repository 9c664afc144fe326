#pragma once

// Where bones and carriers take places, tethers and pulls; see sim/realtime/loops.h.

#include "sim/lanes/lanes.h"
#include "sim/realtime/loops_common.h"
#include "sim/realtime/packed.h"

namespace fascia::sim::realtime {
namespace {

using namespace lanes::FASCIA_LANES_NAMESPACE;

/// Sine and 1 - cosine up to an angle of 3.2: of the half, by their series, then doubled.
FASCIA_INLINE void turn_of(const Lanes& angle, Lanes& sine, Lanes& versine) {
  const Lanes h = 0.5F * angle, s = h * h;
  const Lanes half_sine =
      h *
      (1.0F - s * ((1.0F / 6) -
                   s * ((1.0F / 120) - s * ((1.0F / 5040) - s * ((1.0F / 362880) - s * (1.0F / 39916800))))));
  const Lanes half_cosine =
      1.0F - s * (0.5F - s * ((1.0F / 24) -
                              s * ((1.0F / 720) -
                                   s * ((1.0F / 40320) - s * ((1.0F / 3628800) - s * (1.0F / 479001600))))));
  sine = 2.0F * half_sine * half_cosine;
  versine = 2.0F * half_sine * half_sine;
}

/// What turning adds to an arm (Rodrigues).
FASCIA_INLINE Lanes3 turned(const Lanes3& axis, const Lanes& sine, const Lanes& versine, const Lanes3& arm) {
  const Lanes3 across = cross(axis, arm);
  return sine * across + versine * cross(axis, across);
}

/// What the share of the jaw's pose that a node takes adds to an arm from the joint, without the glide: see
/// jaw_transform.
FASCIA_INLINE Lanes3 jaw_turn(const Driven& driven, const Lanes& share, const Lanes3& arm) {
  const Lanes3 up = splat3(driven.jaw_up), lateral = splat3(driven.jaw_lateral);
  Lanes sine, versine;
  turn_of(share * driven.turn_open, sine, versine);
  const Lanes3 first = turned(lateral, sine, versine, arm);
  turn_of(share * driven.turn_lateral, sine, versine);
  return first + turned(up, sine, versine, arm + first);
}

FASCIA_INLINE Lanes shares_at(const Packed& packed, const SixteenAt& at) {
  float list[batch_width];
  for (size_t l = 0; l < batch_width; ++l)
    list[l] = packed.jaw_share[at[l] / 4];
  return load(list);
}

void place(const Packed& packed, const Driven& driven) {
  const Lanes3 origin = splat3(driven.jaw_origin), glide = splat3(driven.glide);
  if (driven.jaw_at_rest) {
    for (size_t i = 0; i < packed.places; i += 16)
      store(driven.carried + i, load(packed.rest + i));
  } else {
    SixteenAt at;
    for (size_t l = 0; l < batch_width; ++l)
      at[l] = static_cast<int32_t>(4 * l);
    for (size_t i = 0; i < packed.places; i += 4 * batch_width) {
      const Lanes3 rest = gather(packed.rest + i, at);
      const Lanes share = load(packed.jaw_share + i / 4);
      interleave(rest + (jaw_turn(driven, share, rest - origin) + share * glide), driven.carried + i);
    }
  }
  for (size_t b = 0; b < packed.tether_batches; ++b) {
    const TetherBatch& t = packed.tethers[b];
    Lanes3 normal = load3(t.normal);
    if (!driven.jaw_at_rest) normal += jaw_turn(driven, shares_at(packed, t.at), normal);
    float* to = driven.tether_normals + 3 * batch_width * b;
    store(to, normal.x);
    store(to + batch_width, normal.y);
    store(to + 2 * batch_width, normal.z);
  }
  for (size_t b = 0; b < packed.carrier_batches; ++b) {
    const CarrierBatch& c = packed.carriers[b];
    const Lanes value = channel_values(driven.values, c.channel), none = splat(0.0F);
    const Lanes angle = where_below(value, none, -(value * load(c.reverse)), value * load(c.angle));
    Lanes sine, versine;
    turn_of(angle, sine, versine);
    const Lanes3 pull =
        load(c.drive) * turned(load3(c.axis), sine, versine, gather(driven.carried, c.at) - load3(c.origin));
    float* to = driven.carrier_pulls + 3 * batch_width * b;
    store(to, pull.x);
    store(to + batch_width, pull.y);
    store(to + 2 * batch_width, pull.z);
  }
}

}  // namespace
}  // namespace fascia::sim::realtime
