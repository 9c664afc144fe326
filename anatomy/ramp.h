#pragma once

#include "geometry/smoothstep.h"

namespace fascia::anatomy {

/// The interval of a transition, begin < end.
struct Ramp {
  double begin = 0.0, end = 0.0;
  /// 0 up to `begin`, 1 from `end` on, smooth between.
  double rise(double x) const { return smoothstep(begin, end, x); }
  /// 1 up to `begin`, 0 from `end` on.
  double fall(double x) const { return 1.0 - smoothstep(begin, end, x); }
};

}  // namespace fascia::anatomy
