#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

namespace fascia::formats {

/// XXH3 in 128 bits of `bytes`, as 32 hexadecimal digits, as printed by `xxhsum -H2`. Identifies contents; it
/// is not a cryptographic hash.
std::string content_hash(std::span<const uint8_t> bytes);
/// The same of a regular file, read in pieces. Throws fascia::Error if it cannot be read.
std::string content_hash(const std::filesystem::path& file);

}  // namespace fascia::formats
