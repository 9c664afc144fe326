#pragma once

// Common parts of a face's loops; see sim/realtime/loops.h.

#include "sim/lanes/lanes.h"
#include "sim/realtime/packed.h"

namespace fascia::sim::realtime {
namespace {

using namespace lanes::FASCIA_LANES_NAMESPACE;

FASCIA_INLINE Lanes3 load3(const Sixteen* list) {
  return {load(list[0]), load(list[1]), load(list[2])};
}
FASCIA_INLINE Lanes3 splat3(const float* list) {
  return {splat(list[0]), splat(list[1]), splat(list[2])};
}
FASCIA_INLINE Lanes channel_values(const float* values, const SixteenAt& channel) {
  float list[batch_width];
  for (size_t l = 0; l < batch_width; ++l)
    list[l] = values[channel[l]];
  return load(list);
}

using formulas::positive;

}  // namespace
}  // namespace fascia::sim::realtime
