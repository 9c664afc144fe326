// Files of activations. All values are finite.
#include <cmath>

#include "formats/activation_file.h"
#include "geometry/error.h"
#include "tests/fuzz/scratch_file.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  try {
    for (const auto& [name, value] :
         fascia::formats::read_activations(fascia::fuzz::scratch_file(bytes, size, ".json")))
      if (!std::isfinite(value)) __builtin_trap();
  } catch (const fascia::Error&) {
  }
  return 0;
}
