#include "formats/content_hash.h"

#define XXH_INLINE_ALL
#include <xxhash.h>

#include <cstdio>

#include "formats/files.h"

namespace fascia::formats {

namespace {

std::string digits_of(const XXH128_hash_t& hash) {
  char text[33];
  std::snprintf(text, sizeof text, "%016llx%016llx", static_cast<unsigned long long>(hash.high64),
                static_cast<unsigned long long>(hash.low64));
  return text;
}

}  // namespace

std::string content_hash(std::span<const uint8_t> bytes) {
  return digits_of(XXH3_128bits(bytes.data(), bytes.size()));
}

std::string content_hash(const std::filesystem::path& file) {
  alignas(64) XXH3_state_t state;
  XXH3_128bits_reset(&state);
  read_pieces(
      file, [&](std::span<const uint8_t> piece) { XXH3_128bits_update(&state, piece.data(), piece.size()); });
  return digits_of(XXH3_128bits_digest(&state));
}

}  // namespace fascia::formats
