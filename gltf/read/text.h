#pragma once

#include <cstddef>
#include <string>
#include <string_view>

/// What has to be true of a text before a JSON library may see it, and before it goes into JSON.
namespace fascia::gltf {

/// Deepest nesting of arrays and objects that is read. Parsers recurse, and a host's thread may have a small
/// stack.
inline constexpr std::size_t greatest_depth = 200;

/// Throws fascia::Error naming `name` when arrays and objects in the JSON text are nested deeper than
/// `greatest_depth`. Brackets within strings do not count; the text need not be sound JSON.
void check_depth(std::string_view json, const std::string& name);

/// True when `text` is well-formed UTF-8 (RFC 3629: no overlong forms, no surrogates, at most U+10FFFF).
bool is_utf8(std::string_view text);

/// `text` itself when it is UTF-8; else every byte that is not part of a well-formed sequence read as
/// Latin-1.
std::string as_utf8(std::string_view text);

}  // namespace fascia::gltf
