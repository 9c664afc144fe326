#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace fascia::gltf {

/// A glTF file as its JSON text and the bytes of buffer 0 (none when that has a URI).
struct Document {
  std::string json;
  std::vector<uint8_t> bin;
};

}  // namespace fascia::gltf
