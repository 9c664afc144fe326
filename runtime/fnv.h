#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace fascia::runtime {

/// A hash of bytes against accidents, not against adversaries: the steps of FNV-1a (Fowler, Noll and Vo,
/// draft-eastlake-fnv) by words of 64 bits, whose upper half is folded into the lower.
class Fnv1a {
 public:
  void add(const void* bytes, std::size_t size) {
    for (std::size_t at = 0; at < size; at += sizeof(uint64_t)) {
      uint64_t word = 0;
      std::memcpy(&word, static_cast<const uint8_t*>(bytes) + at, std::min(sizeof word, size - at));
      step(word);
    }
    step(size);
  }

  uint64_t value() const { return value_; }

 private:
  void step(uint64_t word) {
    value_ = (value_ ^ word) * 1099511628211ULL;
    value_ ^= value_ >> 32;
  }

  uint64_t value_ = 14695981039346656037ULL;
};

/// The hash of `size` bytes alone.
inline uint64_t hash_of(const void* bytes, std::size_t size) {
  Fnv1a hash;
  hash.add(bytes, size);
  return hash.value();
}

}  // namespace fascia::runtime
