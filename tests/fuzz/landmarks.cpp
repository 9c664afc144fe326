// Files of landmarks: 3D Slicer's and our own.
#include "formats/landmark_file.h"
#include "geometry/error.h"
#include "tests/fuzz/scratch_file.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  if (size < 1) return 0;
  try {
    fascia::formats::read_landmarks(
        fascia::fuzz::scratch_file(bytes + 1, size - 1, bytes[0] % 2 ? ".json" : ".mrk.json"));
  } catch (const fascia::Error&) {
  }
  return 0;
}
