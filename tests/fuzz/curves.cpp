// Curves of every kind, by content. Values and times that are taken are finite.
#include <fascia/fascia.h>

#include <cmath>

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  fascia_curves* curves = nullptr;
  if (fascia_curves_load(bytes, size, &curves) != FASCIA_OK) {
    if (fascia_last_message()[0] == 0) __builtin_trap();
    return 0;
  }
  fascia_curves_info info = {};
  info.struct_size = sizeof info;
  if (fascia_curves_get_info(curves, &info) != FASCIA_OK || !std::isfinite(info.duration) ||
      info.duration < 0.0 || !std::isfinite(info.start))
    __builtin_trap();
  for (int k = -1; k <= 8; ++k) {
    float turn[4] = {};
    if (fascia_curves_head(curves, info.duration * k / 7.0, turn) != FASCIA_OK) __builtin_trap();
    for (const float value : turn)
      if (!std::isfinite(value)) __builtin_trap();
  }
  fascia_curves_release(curves);
  return 0;
}
