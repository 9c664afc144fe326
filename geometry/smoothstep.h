#pragma once

#include <algorithm>

namespace fascia {

/// 0 up to t = 0, 1 from t = 1 on, in between the cubic with zero slope at both ends.
template <class Number>
Number smoothstep(Number t) {
  t = std::clamp(t, Number(0), Number(1));
  return t * t * (Number(3) - Number(2) * t);
}

/// The same from `low` to `high` (low < high).
inline double smoothstep(double low, double high, double x) {
  return smoothstep((x - low) / (high - low));
}

}  // namespace fascia
