#include "runtime/allocator.h"

#include <new>

#include "runtime/message.h"

namespace fascia::runtime {

constinit fascia_allocator hosts_allocator{};
constinit bool can_redirect_memory = false;

namespace {
thread_local bool ran_out = false, deferred = false;
}

bool has_run_out() noexcept {
  return ran_out;
}

void set_run_out(bool has) noexcept {
  ran_out = has;
}

bool are_refusals_deferred() noexcept {
  return deferred;
}

void set_refusals_deferred(bool is_deferred) noexcept {
  deferred = is_deferred;
}

RefusalsDeferred::RefusalsDeferred() noexcept : was_deferred_(deferred), had_run_out_(ran_out) {
  deferred = true;
  ran_out = false;
}

RefusalsDeferred::~RefusalsDeferred() {
  ran_out = was_deferred_ && (ran_out || had_run_out_);
  deferred = was_deferred_;
}

void RefusalsDeferred::finish() const {
  if (ran_out) throw std::bad_alloc();
}

}  // namespace fascia::runtime

extern "C" fascia_result fascia_set_allocator(const fascia_allocator* allocator) {
  using namespace fascia::runtime;
  return guarded([&] {
    if (allocator != nullptr && !can_redirect_memory)
      throw Failure(FASCIA_ERROR_MODULE, "this build of the library takes its memory from malloc alone");
    require(live_handles.load() == 0,
            "assets, faces or curves are loaded already: set the allocator before, or release them");
    require(allocator == nullptr ||
                (allocator->struct_size >= sizeof *allocator && allocator->allocate && allocator->release),
            "the allocator lacks its struct_size, allocate or release");
    hosts_allocator = allocator != nullptr ? *allocator : fascia_allocator{};
    return FASCIA_OK;
  });
}
