#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace fascia::snapshot {

/// Whole numbers as text: differences to the number `stride` before, as variable-length integers, deflated,
/// in base64. Empty for no numbers.
std::string pack(const std::vector<int32_t>& numbers, size_t stride);

/// The `count` numbers of such a text; memory is taken in proportion to the text only. Throws fascia::Error
/// when the text is not one of `count` numbers.
std::vector<int32_t> unpack(std::string_view text, size_t stride, size_t count);

}  // namespace fascia::snapshot
