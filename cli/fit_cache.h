#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <vector>

#include "cli/common.h"
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

/// A cache and where it has the rig's vertices.
struct FitCache {
  PointCache cache;
  std::vector<Match> matches;
};

/// Opens the caches of a take: one of all of the rig's meshes, of the whole OBJ or of one mesh, or the set
/// that `play` writes of a rig of several (NAME.OBJECT.EXT), given any one of them or their common name
/// NAME.EXT. Warns of files of the set that are not there: those meshes are not seen. `fps` gives the frames
/// of PC2, which hold no times, theirs. Throws fascia::Error for a file that is damaged or not of the rig's
/// topology, and for a set of several takes.
std::vector<FitCache> open_caches(const Common& common, const std::filesystem::path& path, double fps,
                                  const fit::Subject& subject);

}  // namespace fascia::cli
