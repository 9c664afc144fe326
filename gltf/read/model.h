#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "gltf/tinygltf/tinygltf.h"

namespace fascia::gltf {

/// Reads the JSON and the buffers of a GLB file with tinygltf: no images, no files beside it. JSON that is
/// nested deeper than `greatest_depth` is refused before any parser sees it. Throws fascia::Error naming
/// `name`.
tinygltf::Model load_model(std::span<const uint8_t> glb, const std::string& name);

}  // namespace fascia::gltf
