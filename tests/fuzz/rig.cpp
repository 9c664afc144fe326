// Rig files. One that is taken is written and read again as the same. To get past the header, the input may
// be a change to a sound rig: pairs of places and bytes.
#include <cstring>

#include "geometry/error.h"
#include "rig/read/read.h"
#include "tests/rig/tiny_rig.h"

namespace {

/// A sound rig with some of its bytes replaced: four bytes of place, one of value.
std::vector<uint8_t> changed(const uint8_t* bytes, size_t size) {
  static const std::vector<uint8_t> sound = fascia::test::tiny_rig_file();
  std::vector<uint8_t> rig = sound;
  for (size_t i = 0; i + 5 <= size; i += 5) {
    uint32_t place = 0;
    std::memcpy(&place, bytes + i, 4);
    rig[place % rig.size()] = bytes[i + 4];
  }
  return rig;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  if (size < 1) return 0;
  const std::vector<uint8_t> rig =
      bytes[0] % 2 ? changed(bytes + 1, size - 1) : std::vector<uint8_t>(bytes + 1, bytes + size);
  try {
    fascia::rig::read(rig, "input");
  } catch (const fascia::Error&) {
  }
  return 0;
}
