#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "fascia/fascia.h"

extern "C" void* __libc_memalign(std::size_t alignment, std::size_t size);

namespace fascia::test {

/// A host's memory that counts what it gave, and refuses when told to.
struct Host {
  int64_t live = 0, made = 0;
  bool is_out = false;     ///< of memory
  int64_t until_out = -1;  ///< allocations before it is; -1: it never will be
  bool recovers = false;   ///< only that one allocation fails

  /// The allocation after the next `count` fails: alone, or with all that follow.
  void refuse_after(int64_t count, bool alone) {
    until_out = count;
    recovers = alone;
  }
  void refuse_no_more() {
    until_out = -1;
    is_out = false;
  }
};

inline void* allocate(size_t size, size_t alignment, void* user) {
  auto* host = static_cast<Host*>(user);
  if (host->until_out == 0 && !host->recovers) host->is_out = true;
  if (host->until_out >= 0 && host->until_out-- == 0) return nullptr;
  if (host->is_out) return nullptr;
  ++host->live;
  ++host->made;
  return __libc_memalign(alignment, size);  // past the counters of memory_test.cpp
}

inline void release(void* block, void* user) {
  --static_cast<Host*>(user)->live;
  std::free(block);
}

}  // namespace fascia::test
