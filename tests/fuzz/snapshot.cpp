// Snapshots and the poses they are recorded of. A snapshot that is taken is written back the same.
#include <string_view>

#include "geometry/error.h"
#include "snapshot/compare.h"
#include "snapshot/file.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  if (size < 1) return 0;
  const std::string_view text(reinterpret_cast<const char*>(bytes) + 1, size - 1);
  try {
    if (bytes[0] % 2) {
      const fascia::snapshot::Snapshot snapshot = fascia::snapshot::from_text(text, "input");
      fascia::snapshot::compare(snapshot, snapshot);
      const std::string again = fascia::snapshot::to_text(snapshot);
      if (fascia::snapshot::to_text(fascia::snapshot::from_text(again, "again")) != again) __builtin_trap();
    } else {
      fascia::snapshot::Request request;
      fascia::snapshot::read_poses(text, "input", request);
    }
  } catch (const fascia::Error&) {
  }
  return 0;
}
