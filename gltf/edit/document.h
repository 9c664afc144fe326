#pragma once

#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "gltf/read/document.h"

namespace fascia::gltf {

using Json = nlohmann::ordered_json;

/// A file referenced by a glTF: its bytes, or why it is not available, with a remedy.
struct OutsideFile {
  std::optional<std::vector<uint8_t>> bytes;
  std::string why;
};

/// Opens a file by its URI, percent escapes replaced; never called with a data URI or one that names a
/// scheme.
using Resolver = std::function<OutsideFile(const std::string& uri)>;

/// The two chunks of a GLB file. Throws fascia::Error naming `name`.
Document glb_document(std::span<const uint8_t> bytes, const std::string& name);

/// `json` parsed, once its depth is known to be sound. Text that is not UTF-8 is read as Latin-1 where it is
/// not; `repaired` says so. Throws fascia::Error naming `name` when it is not a JSON object.
Json parsed(const std::string& json, const std::string& name, bool* repaired = nullptr);

/// The JSON as text; what is not UTF-8 in it becomes U+FFFD.
std::string text_of(const Json& json);

/// The document made self-contained and uncompressed: every buffer joined into one binary chunk (the bytes of
/// buffer 0 first), pictures taken in with their own media types, EXT_meshopt_compression and
/// KHR_draco_mesh_compression undone. Everything else is preserved; a document that needs none of this is
/// returned unchanged.
///
/// An image that is missing, on the web or refused keeps its URI, with a warning. Throws fascia::Error,
/// beginning with `name`, when the JSON is malformed, a buffer is missing or cut short, or compressed data
/// are damaged, or an index, offset or count is no whole number or too large. Whole ones that are written as
/// decimals become integers.
Document self_contained(Document document, const Resolver& resolve, const std::string& name,
                        std::vector<std::string>* warnings = nullptr);

}  // namespace fascia::gltf
