#pragma once

#include "formats/scene.h"

namespace fascia::formats {

/// Takes a GLB or glTF apart into one JSON text and one binary chunk. Buffers and images kept in
/// other files or in data URIs are brought into the chunk; everything else in the JSON stays as it was.
///
/// `path` serves for messages and to find the files beside it. Throws fascia::Error when the container
/// is damaged, the JSON does not parse, or a file it names is missing.
GltfDocument gltf_document(const std::filesystem::path& path, const std::vector<uint8_t>& bytes);

/// The document as a GLB container (glTF 2.0, section 4).
std::vector<uint8_t> glb_bytes(const GltfDocument& document);

}  // namespace fascia::formats
