#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace fascia::runtime {

/// The bytes of a text file as UTF-8 without a byte order mark: UTF-8 as it is, UTF-16 of either order, known
/// by its mark or by its zero bytes. A character that is none becomes U+FFFD.
std::string utf8_text(std::span<const uint8_t> bytes);

/// The lines of a text that ends them with LF, CR LF or CR, empty ones too.
std::vector<std::string_view> lines_of(std::string_view text);

/// `text` without blanks and tabs at its ends.
std::string_view trimmed(std::string_view text);

/// `text` as a message shows it: what is longer than 60 bytes is cut short, between characters.
std::string shown(std::string_view text);

/// ASCII letters of `text` in lower case.
std::string lower_ascii(std::string_view text);

/// A decimal number that fills the whole of `text`, whatever the process's locale: sign, digits with a point
/// (or a comma, when `decimal_comma`), exponent. Nothing for other text, and for what is not finite.
std::optional<double> number(std::string_view text, bool decimal_comma = false);

}  // namespace fascia::runtime
