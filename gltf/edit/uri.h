#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace fascia::gltf {

/// Content and media type (empty when it names none) of a data URI (RFC 2397, base 64).
struct DataUri {
  std::vector<uint8_t> bytes;
  std::string media_type;
};

/// The content of `uri`, or nothing when it is no data URI. Throws fascia::Error when it is one that is not
/// base 64.
std::optional<DataUri> data_uri(std::string_view uri);

/// `uri` with its percent escapes replaced by the bytes they stand for (RFC 3986, section 2.1).
std::string percent_decoded(std::string_view uri);

/// True when `uri` names a scheme, such as https: or file: (RFC 3986, section 3.1; data URIs too).
bool has_scheme(std::string_view uri);

/// Media type of a picture by its first bytes: PNG, JPEG, WebP, KTX2, AVIF, GIF, BMP or DDS; empty when it is
/// none.
std::string picture_type(std::span<const uint8_t> bytes);

/// Media type of a picture by the extension of its file name; empty when it is not known.
std::string picture_type_of_name(std::string_view name);

}  // namespace fascia::gltf
