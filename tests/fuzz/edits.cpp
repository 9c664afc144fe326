// Edits: a user's landmarks, regions, strengths and muscles.
#include "builder/rigging/edits.h"
#include "geometry/error.h"
#include "tests/fuzz/scratch_file.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  try {
    fascia::rigging::read_edits(fascia::fuzz::scratch_file(bytes, size, ".json"));
  } catch (const fascia::Error&) {
  }
  return 0;
}
