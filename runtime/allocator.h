#pragma once

#include <atomic>
#include <cstdint>

#include "fascia/fascia.h"

namespace fascia::runtime {

/// Where the library's memory comes from: the host when `allocate` is not null.
extern fascia_allocator hosts_allocator;
/// Whether this build can redirect its memory: set by allocator_wrapped.cpp where that is linked in.
extern bool can_redirect_memory;

/// Whether memory ran out on this thread in the call of the C interface that it is in. Kept because third
/// parties catch std::bad_alloc and go on as though the file were at fault.
bool has_run_out() noexcept;
void set_run_out(bool has) noexcept;

/// Assets, faces and curves that the host holds: all memory of the library but for tables kept for good.
inline std::atomic<int64_t> live_handles{0};

/// A member of what the host holds.
struct CountedHandle {
  CountedHandle() { ++live_handles; }
  ~CountedHandle() { --live_handles; }
  CountedHandle(const CountedHandle&) = delete;
  CountedHandle& operator=(const CountedHandle&) = delete;
};

}  // namespace fascia::runtime
