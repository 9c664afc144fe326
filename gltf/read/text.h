#pragma once

#include <string>
#include <string_view>

/// What has to be true of a text before it goes into JSON.
namespace fascia::gltf {

/// True when `text` is well-formed UTF-8 (RFC 3629: no overlong forms, no surrogates, at most U+10FFFF).
bool is_utf8(std::string_view text);

/// `text` itself when it is UTF-8; else every byte that is not part of a well-formed sequence read as
/// Latin-1.
std::string as_utf8(std::string_view text);

}  // namespace fascia::gltf
