#include "runtime/drivers/text.h"

#include <cmath>
#include <locale>
#include <sstream>

namespace fascia::runtime {
namespace {

void append_utf8(std::string& text, uint32_t code) {
  if (code < 0x80) {
    text += static_cast<char>(code);
  } else if (code < 0x800) {
    text += static_cast<char>(0xC0 | (code >> 6));
    text += static_cast<char>(0x80 | (code & 0x3F));
  } else if (code < 0x10000) {
    text += static_cast<char>(0xE0 | (code >> 12));
    text += static_cast<char>(0x80 | ((code >> 6) & 0x3F));
    text += static_cast<char>(0x80 | (code & 0x3F));
  } else {
    text += static_cast<char>(0xF0 | (code >> 18));
    text += static_cast<char>(0x80 | ((code >> 12) & 0x3F));
    text += static_cast<char>(0x80 | ((code >> 6) & 0x3F));
    text += static_cast<char>(0x80 | (code & 0x3F));
  }
}

std::string from_utf16(std::span<const uint8_t> bytes, bool big_endian) {
  std::string text;
  text.reserve(bytes.size() / 2);
  const auto unit = [&](std::size_t i) {
    return static_cast<uint32_t>(big_endian ? bytes[i] << 8 | bytes[i + 1] : bytes[i + 1] << 8 | bytes[i]);
  };
  for (std::size_t i = 0; i + 1 < bytes.size(); i += 2) {
    uint32_t code = unit(i);
    if (code >= 0xD800 && code < 0xE000) {
      const uint32_t next = i + 3 < bytes.size() ? unit(i + 2) : 0;
      if (code < 0xDC00 && next >= 0xDC00 && next < 0xE000) {
        code = 0x10000 + ((code - 0xD800) << 10) + (next - 0xDC00);
        i += 2;
      } else {
        code = 0xFFFD;
      }
    }
    append_utf8(text, code);
  }
  return text;
}

constexpr double powers_of_ten[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,  1e8,  1e9,  1e10, 1e11,
                                    1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

/// For numbers whose digits or exponent a double cannot hold exactly.
std::optional<double> slow_number(const std::string& text) {
  std::istringstream stream(text);
  stream.imbue(std::locale::classic());
  double value = 0;
  if (!(stream >> value) || stream.peek() != std::istringstream::traits_type::eof() || !std::isfinite(value))
    return std::nullopt;
  return value;
}

}  // namespace

std::string utf8_text(std::span<const uint8_t> bytes) {
  if (bytes.size() >= 2 && bytes[0] == 0xFF && bytes[1] == 0xFE) return from_utf16(bytes.subspan(2), false);
  if (bytes.size() >= 2 && bytes[0] == 0xFE && bytes[1] == 0xFF) return from_utf16(bytes.subspan(2), true);
  // A table's first characters are ASCII: every other byte of its UTF-16 is zero.
  if (bytes.size() >= 4 && bytes[0] != 0 && bytes[1] == 0 && bytes[2] != 0 && bytes[3] == 0)
    return from_utf16(bytes, false);
  if (bytes.size() >= 4 && bytes[0] == 0 && bytes[1] != 0 && bytes[2] == 0 && bytes[3] != 0)
    return from_utf16(bytes, true);
  if (bytes.size() >= 3 && bytes[0] == 0xEF && bytes[1] == 0xBB && bytes[2] == 0xBF) bytes = bytes.subspan(3);
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

std::vector<std::string_view> lines_of(std::string_view text) {
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const std::size_t end = text.find_first_of("\r\n");
    lines.push_back(text.substr(0, end));
    if (end == std::string_view::npos) break;
    text.remove_prefix(end + (text.compare(end, 2, "\r\n") == 0 ? 2 : 1));
  }
  return lines;
}

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t");
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(" \t") - first + 1);
}

std::string shown(std::string_view text) {
  constexpr std::size_t most = 60;
  if (text.size() <= most) return std::string(text);
  std::size_t end = most;
  while (end > 0 && (static_cast<uint8_t>(text[end]) & 0xC0) == 0x80)  // within a character of UTF-8
    --end;
  return std::string(text.substr(0, end)) + "...";
}

std::string lower_ascii(std::string_view text) {
  std::string lower(text);
  for (char& c : lower)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return lower;
}

std::optional<double> number(std::string_view text, bool decimal_comma) {
  std::string plain;  // for the slow way
  plain.reserve(text.size());
  std::size_t at = 0;
  const auto is_digit = [&] { return at < text.size() && text[at] >= '0' && text[at] <= '9'; };
  const auto take = [&] { plain += text[at++]; };
  bool is_negative = false;
  if (at < text.size() && (text[at] == '+' || text[at] == '-')) {
    is_negative = text[at++] == '-';
  }
  uint64_t digits = 0;
  int count = 0, exponent = 0, seen = 0;
  const auto digit = [&](bool is_fraction) {
    if (count < 19) {
      digits = digits * 10 + static_cast<uint64_t>(text[at] - '0');
      if (digits > 0) ++count;
      exponent -= is_fraction;
    } else {
      ++count;
      exponent += !is_fraction;
    }
    ++seen;
    take();
  };
  while (is_digit())
    digit(false);
  if (at < text.size() && (text[at] == '.' || (decimal_comma && text[at] == ','))) {
    plain += '.';
    ++at;
    while (is_digit())
      digit(true);
  }
  if (seen == 0) return std::nullopt;
  if (at < text.size() && (text[at] == 'e' || text[at] == 'E')) {
    take();
    bool is_below = false;
    if (at < text.size() && (text[at] == '+' || text[at] == '-')) {
      is_below = text[at] == '-';
      take();
    }
    if (!is_digit()) return std::nullopt;
    int written = 0;
    while (is_digit()) {
      written = std::min(written * 10 + (text[at] - '0'), 100000);
      take();
    }
    exponent += is_below ? -written : written;
  }
  if (at != text.size()) return std::nullopt;
  // Exact in one rounding: the digits and the power of ten are doubles (Clinger 1990).
  if (digits <= (uint64_t{1} << 53) && count <= 19 && exponent >= -22 && exponent <= 22) {
    const auto mantissa = static_cast<double>(digits);
    const double value =
        exponent < 0 ? mantissa / powers_of_ten[-exponent] : mantissa * powers_of_ten[exponent];
    return is_negative ? -value : value;
  }
  const auto value = slow_number(plain);
  if (!value && digits != 0 && exponent + count < -300) return 0.0;
  return value && is_negative ? -*value : value;
}

}  // namespace fascia::runtime
