// The host's allocator. The shared library is linked with --wrap, so that its own code, libstdc++'s (linked
// in) and Eigen's reach malloc and the like through here. Linux only: see runtime/CMakeLists.txt.
#include <malloc.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <mutex>

#include "runtime/allocator.h"

extern "C" {
void* __real_malloc(std::size_t size);
void* __real_calloc(std::size_t count, std::size_t size);
void* __real_realloc(void* block, std::size_t size);
void* __real_aligned_alloc(std::size_t alignment, std::size_t size);
int __real_posix_memalign(void** block, std::size_t alignment, std::size_t size);
void __real_free(void* block);
void* __wrap_malloc(std::size_t size);
void* __wrap_calloc(std::size_t count, std::size_t size);
void* __wrap_realloc(void* block, std::size_t size);
void* __wrap_aligned_alloc(std::size_t alignment, std::size_t size);
int __wrap_posix_memalign(void** block, std::size_t alignment, std::size_t size);
void __wrap_free(void* block);
}

namespace {

const bool is_announced = fascia::runtime::can_redirect_memory = true;
fascia_allocator& host = fascia::runtime::hosts_allocator;

constexpr std::size_t usual_alignment = alignof(std::max_align_t);
static_assert(usual_alignment == 16);
constexpr std::size_t largest_alignment = std::size_t{1} << 15;

/// Before a host's block: its size, and a mark that tells it from malloc's, which holds the alignment's
/// logarithm. Blocks of before the host set its allocator (texts of static objects) are given back when the
/// program ends, while the host's allocator may still be set.
struct Notes {
  uint64_t size, mark;
};
constexpr uint64_t secret = 0x9E3779B97F4A7C10ULL;
std::atomic<bool> is_any_hosts{false};

Notes notes_of(const void* block) {
  Notes notes{};
  std::memcpy(&notes, static_cast<const char*>(block) - sizeof notes, sizeof notes);
  return notes;
}

/// A block of malloc's is told by what glibc keeps before it, which is read here.
bool is_hosts(const void* block) {
  return is_any_hosts.load(std::memory_order_relaxed) &&
         (notes_of(block).mark & ~uint64_t{15}) == (reinterpret_cast<uintptr_t>(block) ^ secret);
}

/// A host's block with its notes. `alignment` at least usual_alignment.
void* hosts_block(std::size_t size, std::size_t alignment) {
  if (alignment > largest_alignment || size > SIZE_MAX - alignment) return nullptr;
  auto* const raw = static_cast<char*>(host.allocate(size + alignment, alignment, host.user));
  if (raw == nullptr) return nullptr;
  char* const block = raw + alignment;
  const Notes notes = {size, (reinterpret_cast<uintptr_t>(block) ^ secret) |
                                 static_cast<uint64_t>(std::countr_zero(alignment))};
  std::memcpy(block - sizeof notes, &notes, sizeof notes);
  is_any_hosts.store(true, std::memory_order_relaxed);
  return block;
}

/// Blocks are returned to the current allocator; memory kept for the process is leaked if the host removed
/// it.
void give_back_to_host(void* block) {
  const Notes notes = notes_of(block);
  const uint64_t nothing = 0;
  std::memcpy(static_cast<char*>(block) - sizeof nothing, &nothing, sizeof nothing);  // no block any more
  if (host.release != nullptr)
    host.release(static_cast<char*>(block) - (std::size_t{1} << (notes.mark & 15)), host.user);
}

/// Emergency reserve: unwinding after out-of-memory also allocates (nlohmann's destructor fills a list of
/// what it is to delete), and a destructor that cannot would end the host's program. Freeing the last block
/// makes its memory available again; freeing every block makes all of it available.
class Reserve {
 public:
  static constexpr std::size_t whole = 4 << 20, half = whole / 2;

  /// A block that ends within the first `limit` bytes, or null.
  void* take(std::size_t size, std::size_t alignment, std::size_t limit = whole) {
    const std::lock_guard lock(mutex_);
    const std::size_t begin = (used_ + sizeof(uint64_t) + alignment - 1) / alignment * alignment;
    if (begin > limit || size > limit - begin) return nullptr;
    const uint64_t note = size;
    std::memcpy(bytes_ + begin - sizeof note, &note, sizeof note);
    used_ = begin + size;
    ++live_;
    return bytes_ + begin;
  }
  bool has(const void* block) const {
    const auto address = reinterpret_cast<uintptr_t>(block), begin = reinterpret_cast<uintptr_t>(bytes_);
    return address - begin < sizeof bytes_;
  }
  void give_back(const void* block) {
    const std::lock_guard lock(mutex_);
    const std::size_t begin = static_cast<std::size_t>(static_cast<const char*>(block) - bytes_);
    if (begin + size_of(block) == used_) used_ = begin - sizeof(uint64_t);
    if (--live_ == 0) used_ = 0;
  }
  static std::size_t size_of(const void* block) {
    uint64_t size = 0;
    std::memcpy(&size, static_cast<const char*>(block) - sizeof size, sizeof size);
    return size;
  }

 private:
  alignas(4096) char bytes_[whole] = {};
  std::mutex mutex_;
  std::size_t used_ = 0, live_ = 0;
};
constinit Reserve reserve;

/// After the first refusal, which the caller gets to know, blocks come from the reserve.
void* refused(std::size_t size, std::size_t alignment) {
  if (fascia::runtime::are_refusals_deferred()) {
    fascia::runtime::set_run_out(true);
    if (void* const block = reserve.take(size, alignment, Reserve::half)) return block;
    fascia::runtime::set_refusals_deferred(
        false);  // this one is the caller's to know, the rest is for undoing
    return nullptr;
  }
  if (fascia::runtime::has_run_out()) return reserve.take(size, alignment);
  fascia::runtime::set_run_out(true);
  return nullptr;
}

void* aligned(std::size_t alignment, std::size_t size) {
  void* const block = host.allocate != nullptr ? hosts_block(size, std::max(alignment, usual_alignment))
                                               : __real_aligned_alloc(alignment, size);
  return block != nullptr ? block : refused(size, std::max(alignment, usual_alignment));
}

}  // namespace

extern "C" {

void* __wrap_malloc(std::size_t size) {
  void* const block = host.allocate != nullptr ? hosts_block(size, usual_alignment) : __real_malloc(size);
  return block != nullptr ? block : refused(size, usual_alignment);
}

void* __wrap_calloc(std::size_t count, std::size_t size) {
  if (host.allocate == nullptr)
    if (void* const block = __real_calloc(count, size)) return block;
  if (size != 0 && count > SIZE_MAX / size) return nullptr;
  void* const block = __wrap_malloc(count * size);
  if (block != nullptr) std::memset(block, 0, count * size);
  return block;
}

void* __wrap_realloc(void* block, std::size_t size) {
  if (block == nullptr) return __wrap_malloc(size);
  const bool is_reserves = reserve.has(block), is_malloced = !is_reserves && !is_hosts(block);
  if (host.allocate == nullptr && is_malloced) return __real_realloc(block, size);
  void* const grown = __wrap_malloc(size);
  if (grown == nullptr) return nullptr;
  const std::size_t held = is_reserves   ? Reserve::size_of(block)
                           : is_malloced ? malloc_usable_size(block)
                                         : notes_of(block).size;
  std::memcpy(grown, block, std::min<std::size_t>(size, held));
  __wrap_free(block);
  return grown;
}

void* __wrap_aligned_alloc(std::size_t alignment, std::size_t size) {
  return aligned(alignment, size);
}

int __wrap_posix_memalign(void** block, std::size_t alignment, std::size_t size) {
  if (host.allocate == nullptr && __real_posix_memalign(block, alignment, size) == 0) return 0;
  *block = aligned(alignment, size);
  return *block != nullptr ? 0 : ENOMEM;
}

void __wrap_free(void* block) {
  if (block == nullptr) return;
  if (reserve.has(block))
    reserve.give_back(block);
  else if (is_hosts(block))
    give_back_to_host(block);
  else
    __real_free(block);
}

}  // extern "C"
