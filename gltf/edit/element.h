#pragma once

#include <cstddef>
#include <string>

namespace fascia::gltf {

/// Component types of accessors (glTF 2.0, 3.6.2.2).
enum Component { int8 = 5120, uint8 = 5121, int16 = 5122, uint16 = 5123, uint32 = 5125, float32 = 5126 };

/// Bytes of a number of that type; 0 when there is no such type.
inline std::size_t bytes_of(int component) {
  switch (component) {
    case int8:
    case uint8:
      return 1;
    case int16:
    case uint16:
      return 2;
    case uint32:
    case float32:
      return 4;
    default:
      return 0;
  }
}

/// Numbers in an element of an accessor of that `type`; 0 of a matrix, whose columns may be padded.
inline std::size_t components_of(const std::string& type) {
  if (type == "SCALAR") return 1;
  if (type == "VEC2") return 2;
  if (type == "VEC3") return 3;
  return type == "VEC4" ? 4 : 0;
}

}  // namespace fascia::gltf
