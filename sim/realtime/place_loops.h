#pragma once

// Where bones and carriers take places, tethers and pulls; see sim/realtime/loops.h.

#include "sim/formulas/motion.h"
#include "sim/lanes/lanes.h"
#include "sim/realtime/loops_common.h"
#include "sim/realtime/packed.h"

namespace fascia::sim::realtime {
namespace {

using namespace lanes::FASCIA_LANES_NAMESPACE;

/// What the share of the jaw's pose that a node takes adds to an arm from the joint, without the glide.
FASCIA_INLINE Lanes3 jaw_turn(const Boundary& boundary, const Lanes& share, const Lanes3& arm) {
  return formulas::jaw_turn(splat3(boundary.jaw_lateral), splat3(boundary.jaw_up), share * boundary.turn_open,
                            share * boundary.turn_lateral, arm);
}

FASCIA_INLINE Lanes shares_at(const Packed& packed, const SixteenAt& at) {
  float list[batch_width];
  for (size_t l = 0; l < batch_width; ++l)
    list[l] = packed.jaw_share[at[l] / 4];
  return load(list);
}

void place(const Packed& packed, const Boundary& boundary) {
  const Lanes3 origin = splat3(boundary.jaw_origin), glide = splat3(boundary.glide);
  if (boundary.jaw_at_rest) {
    for (size_t i = 0; i < packed.places; i += 16)
      store(boundary.carried + i, load(packed.rest + i));
  } else {
    SixteenAt at;
    for (size_t l = 0; l < batch_width; ++l)
      at[l] = static_cast<int32_t>(4 * l);
    for (size_t i = 0; i < packed.places; i += 4 * batch_width) {
      const Lanes3 rest = gather(packed.rest + i, at);
      const Lanes share = load(packed.jaw_share + i / 4);
      interleave(rest + (jaw_turn(boundary, share, rest - origin) + share * glide), boundary.carried + i);
    }
  }
  for (size_t b = 0; b < packed.tether_batches; ++b) {
    const TetherBatch& t = packed.tethers[b];
    Lanes3 normal = load3(t.normal);
    if (!boundary.jaw_at_rest) normal += jaw_turn(boundary, shares_at(packed, t.at), normal);
    float* to = boundary.tether_normals + 3 * batch_width * b;
    store(to, normal.x);
    store(to + batch_width, normal.y);
    store(to + 2 * batch_width, normal.z);
  }
  for (size_t b = 0; b < packed.carrier_batches; ++b) {
    const CarrierBatch& c = packed.carriers[b];
    const Lanes3 arm = gather(boundary.carried, c.at) - load3(c.origin);
    const Lanes3 pull =
        formulas::rotary_pull(load(c.pull_stiffness), channel_values(boundary.values, c.channel),
                              load(c.angle), load(c.reverse), load3(c.axis), arm);
    float* to = boundary.carrier_pulls + 3 * batch_width * b;
    store(to, pull.x);
    store(to + batch_width, pull.y);
    store(to + 2 * batch_width, pull.z);
  }
}

}  // namespace
}  // namespace fascia::sim::realtime
