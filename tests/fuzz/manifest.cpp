// Manifests of many heads. Every id is a folder's plain name.
#include "batch/manifest.h"
#include "geometry/error.h"
#include "tests/fuzz/scratch_file.h"

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* bytes, size_t size) {
  try {
    for (const fascia::batch::Head& head :
         fascia::batch::read_heads(fascia::fuzz::scratch_file(bytes, size, ".jsonl")))
      if (head.id.empty() || head.id[0] == '.' || head.id.find('/') != std::string::npos) __builtin_trap();
  } catch (const fascia::Error&) {
  }
  return 0;
}
