#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

/// The one way in which JSON that others wrote is parsed.
namespace fascia {

/// Deepest nesting of arrays and objects that is read. JSON values are copied by recursion, and a host's
/// thread may have a small stack.
inline constexpr std::size_t greatest_depth = 200;

/// Throws fascia::Error naming `name` when arrays and objects in the JSON text are nested deeper than
/// `greatest_depth`. Brackets within strings do not count; the text need not be sound JSON.
void check_depth(std::string_view json, const std::string& name);

/// `text` as a nlohmann::json or nlohmann::ordered_json (`Json`), discarded when it is not JSON. Throws
/// fascia::Error naming `name` when it is nested deeper than `greatest_depth`.
template <class Json>
Json parse_json(std::string_view text, const std::string& name) {
  check_depth(text, name);
  return Json::parse(text.begin(), text.end(), nullptr, false);
}

/// The same for the bytes of a file.
template <class Json>
Json parse_json(std::span<const uint8_t> bytes, const std::string& name) {
  return parse_json<Json>(std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size()), name);
}

}  // namespace fascia
