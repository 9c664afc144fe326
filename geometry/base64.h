#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace fascia {

/// `bytes` in base 64 (RFC 4648, section 4), with padding.
std::string to_base64(std::span<const uint8_t> bytes);

/// The bytes of a text in base 64, with or without padding, in the usual or the URL-safe alphabet (RFC 4648,
/// sections 4 and 5). Other characters are skipped; `skipped`, if not null, receives their number.
std::vector<uint8_t> from_base64(std::string_view text, size_t* skipped = nullptr);

}  // namespace fascia
