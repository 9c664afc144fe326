// The host's allocator. The shared library is linked with --wrap, so that its own code, libstdc++'s (linked
// in) and Eigen's reach malloc and the like through here. Linux only: see runtime/CMakeLists.txt.
#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstring>

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

/// A host's block with its size before it, for realloc. `alignment` at least usual_alignment.
void* hosts_block(std::size_t size, std::size_t alignment) {
  if (size > SIZE_MAX - alignment) return nullptr;
  auto* const raw = static_cast<char*>(host.allocate(size + alignment, alignment, host.user));
  if (raw == nullptr) return nullptr;
  const uint64_t notes[2] = {size, alignment};
  std::memcpy(raw + alignment - sizeof notes, notes, sizeof notes);
  return raw + alignment;
}

struct Notes {
  uint64_t size, alignment;
};
Notes notes_of(const void* block) {
  Notes notes{};
  std::memcpy(&notes, static_cast<const char*>(block) - sizeof notes, sizeof notes);
  return notes;
}

void* aligned(std::size_t alignment, std::size_t size) {
  return host.allocate != nullptr ? hosts_block(size, std::max(alignment, usual_alignment))
                                  : __real_aligned_alloc(alignment, size);
}

}  // namespace

extern "C" {

void* __wrap_malloc(std::size_t size) {
  return host.allocate != nullptr ? hosts_block(size, usual_alignment) : __real_malloc(size);
}

void* __wrap_calloc(std::size_t count, std::size_t size) {
  if (host.allocate == nullptr) return __real_calloc(count, size);
  if (size != 0 && count > SIZE_MAX / size) return nullptr;
  void* const block = hosts_block(count * size, usual_alignment);
  if (block != nullptr) std::memset(block, 0, count * size);
  return block;
}

void* __wrap_realloc(void* block, std::size_t size) {
  if (block == nullptr) return __wrap_malloc(size);
  if (host.allocate == nullptr) return __real_realloc(block, size);
  void* const grown = __wrap_malloc(size);
  if (grown == nullptr) return nullptr;
  std::memcpy(grown, block, std::min<std::size_t>(size, notes_of(block).size));
  __wrap_free(block);
  return grown;
}

void* __wrap_aligned_alloc(std::size_t alignment, std::size_t size) {
  return aligned(alignment, size);
}

int __wrap_posix_memalign(void** block, std::size_t alignment, std::size_t size) {
  if (host.allocate == nullptr) return __real_posix_memalign(block, alignment, size);
  *block = aligned(alignment, size);
  return *block != nullptr ? 0 : ENOMEM;
}

void __wrap_free(void* block) {
  if (block == nullptr) return;
  if (host.allocate == nullptr)
    __real_free(block);
  else
    host.release(static_cast<char*>(block) - notes_of(block).alignment, host.user);
}

}  // extern "C"
