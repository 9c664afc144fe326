#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <vector>

#include "cli/fit_match.h"

namespace fascia::cli {

/// Points by frame of a PC2 or MDD cache.
struct PointCache {
  std::vector<uint8_t> bytes;
  size_t points = 0, frames = 0, first = 0;  ///< `first`: where the points begin
  bool is_big_endian = false;
  std::vector<double> times;

  uint32_t word(size_t at) const {
    uint32_t value = 0;
    std::memcpy(&value, bytes.data() + at, 4);
    if (is_big_endian) value = value << 24 | (value & 0xFF00U) << 8 | (value >> 8 & 0xFF00U) | value >> 24;
    return value;
  }
  double real(size_t at) const { return static_cast<double>(std::bit_cast<float>(word(at))); }
  Vec3 point(size_t frame, size_t index) const {
    const size_t at = first + 12 * (frame * points + index);
    return {real(at), real(at + 4), real(at + 8)};
  }
};

/// Reads a PC2 or MDD cache; `fps` gives the frames of PC2, which hold no times, theirs. Throws fascia::Error
/// for what is damaged, truncated or neither.
PointCache read_cache(const std::filesystem::path& path, double fps);

/// What a cache of `points` points holds: the whole OBJ, one object, or all of them one after the other.
/// Throws fascia::Error when it is none of them or more than one object could be meant.
std::vector<Match> cache_matches(const std::filesystem::path& path, size_t points,
                                 const fit::Subject& subject);

}  // namespace fascia::cli
