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

/// While one lives, this thread's allocations that are refused come from a reserve of the library's own, and
/// has_run_out() tells of it; only when that is used up do they fail. So a call's work is done whole or not
/// at all, and third parties whose destructors take memory do not end the host's program where they get none.
/// Every call of the C interface has one (guarded(), released()), and every task on a thread of the host's.
/// finish() throws std::bad_alloc when any was refused.
class RefusalsDeferred {
 public:
  RefusalsDeferred() noexcept;
  ~RefusalsDeferred();
  RefusalsDeferred(const RefusalsDeferred&) = delete;
  RefusalsDeferred& operator=(const RefusalsDeferred&) = delete;
  void finish() const;

 private:
  bool was_deferred_, had_run_out_;  ///< of the call around this one, if any
};
bool are_refusals_deferred() noexcept;
void set_refusals_deferred(bool deferred) noexcept;

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
