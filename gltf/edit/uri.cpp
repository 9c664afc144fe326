#include "gltf/edit/uri.h"

#include <algorithm>
#include <array>
#include <cctype>

#include "geometry/base64.h"
#include "geometry/error.h"
#include "geometry/text.h"

namespace fascia::gltf {
namespace {

int hex_digit(char c) {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

}  // namespace

std::optional<DataUri> data_uri(std::string_view uri) {
  if (lower_case(uri.substr(0, 5)) != "data:") return std::nullopt;
  const std::size_t comma = uri.find(',');
  const std::string_view marker = ";base64";
  if (comma == std::string_view::npos || comma < 5 + marker.size() ||
      uri.substr(comma - marker.size(), marker.size()) != marker)
    throw Error("a data URI in the glTF file is not base 64");
  return DataUri{from_base64(uri.substr(comma + 1)), std::string(uri.substr(5, uri.find_first_of(";,") - 5))};
}

std::string percent_decoded(std::string_view uri) {
  std::string text;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    const int high = uri[i] == '%' && i + 2 < uri.size() ? hex_digit(uri[i + 1]) : -1;
    const int low = high >= 0 ? hex_digit(uri[i + 2]) : -1;
    if (low < 0) {
      text.push_back(uri[i]);
      continue;
    }
    text.push_back(static_cast<char>(16 * high + low));
    i += 2;
  }
  return text;
}

bool has_scheme(std::string_view uri) {
  // A single letter before the colon is a drive of Windows, not a scheme.
  const std::size_t colon = uri.find(':');
  if (colon == std::string_view::npos || colon < 2 || !std::isalpha(static_cast<unsigned char>(uri[0])))
    return false;
  return std::all_of(uri.begin(), uri.begin() + static_cast<std::ptrdiff_t>(colon), [](unsigned char c) {
    return std::isalnum(c) != 0 || c == '+' || c == '-' || c == '.';
  });
}

std::string picture_type(std::span<const uint8_t> bytes) {
  const auto has = [&](std::size_t at, std::string_view text) {
    return bytes.size() >= at + text.size() &&
           std::equal(text.begin(), text.end(), bytes.begin() + static_cast<std::ptrdiff_t>(at),
                      [](char a, uint8_t b) { return static_cast<uint8_t>(a) == b; });
  };
  if (has(0, "\x89PNG")) return "image/png";
  if (has(0, "\xFF\xD8")) return "image/jpeg";
  if (has(0, "RIFF") && has(8, "WEBP")) return "image/webp";
  if (has(0, "\xABKTX 20\xBB")) return "image/ktx2";
  if (has(4, "ftypavif") || has(4, "ftypavis")) return "image/avif";
  if (has(0, "GIF8")) return "image/gif";
  if (has(0, "DDS ")) return "image/vnd-ms.dds";
  if (has(0, "BM")) return "image/bmp";
  return "";
}

std::string picture_type_of_name(std::string_view name) {
  using Pair = std::pair<std::string_view, std::string_view>;
  static constexpr std::array<Pair, 9> known = {{{".png", "image/png"},
                                                 {".jpg", "image/jpeg"},
                                                 {".jpeg", "image/jpeg"},
                                                 {".webp", "image/webp"},
                                                 {".ktx2", "image/ktx2"},
                                                 {".avif", "image/avif"},
                                                 {".gif", "image/gif"},
                                                 {".dds", "image/vnd-ms.dds"},
                                                 {".bmp", "image/bmp"}}};
  const std::size_t dot = name.rfind('.');
  const std::string extension = dot == std::string_view::npos ? "" : lower_case(name.substr(dot));
  for (const auto& [end, type] : known)
    if (end == extension) return std::string(type);
  return "";
}

}  // namespace fascia::gltf
