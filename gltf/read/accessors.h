#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "gltf/tinygltf/tinygltf.h"

namespace fascia::gltf {

using Triangle = std::array<uint32_t, 3>;

/// An accessor's elements in its buffer, every bound checked.
struct AccessorView {
  const uint8_t* data = nullptr;  ///< first element; null when the accessor has no buffer view (all zeros)
  std::size_t count = 0;
  std::size_t stride = 0;  ///< bytes from one element to the next
  int component_type = 0;
  std::size_t components = 0;
  bool normalized = false;

  std::size_t component_size() const;
  std::size_t element_size() const { return components * component_size(); }
};

/// View of accessor `index`. Throws fascia::Error, beginning with `path`, when the index, the buffer view or
/// the range is out of bounds.
AccessorView accessor_view(const tinygltf::Model& model, int index, const std::string& path);

/// Numbers of a VEC2 or VEC3 vertex attribute or a scalar, whatever its component type; sparse values and
/// normalisation applied. Elements lie one after the other. Throws as `accessor_view` does.
std::vector<float> decode_floats(const tinygltf::Model& model, int index, const std::string& path);

/// Triangles of a primitive, strips and fans unrolled; none for points and lines. Throws fascia::Error when
/// an index passes `vertex_count`.
std::vector<Triangle> decode_triangles(const tinygltf::Model& model, const tinygltf::Primitive& primitive,
                                       std::size_t vertex_count, const std::string& path);

/// Fingerprint of an attribute: FNV-1a (Fowler, Noll, Vo) over the 32-bit little-endian words of its
/// elements laid end to end, the last word padded with zero bytes. An accessor without a buffer view
/// counts as zeros; sparse values are applied.
uint64_t attribute_hash(const tinygltf::Model& model, int index, const std::string& path);

}  // namespace fascia::gltf
