#pragma once

#include <cstddef>
#include <string>

namespace fascia::gltf {

/// Numbers in an element of an accessor of that `type`; 0 of a matrix, whose columns may be padded.
inline std::size_t components_of(const std::string& type) {
  if (type == "SCALAR") return 1;
  if (type == "VEC2") return 2;
  if (type == "VEC3") return 3;
  return type == "VEC4" ? 4 : 0;
}

}  // namespace fascia::gltf
