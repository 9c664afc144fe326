#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace fascia::formats {

/// XXH3 in 128 bits of `bytes`, as 32 hexadecimal digits: what `xxhsum -H2` prints for a file of them. For
/// telling contents apart, not for keeping forgers out.
std::string content_hash(std::span<const uint8_t> bytes);

}  // namespace fascia::formats
