#pragma once

#include <cstddef>
#include <vector>

#include "gltf/edit/document.h"

namespace fascia::gltf {

/// Bytes of the binary chunk, `end` not among them.
struct ByteRange {
  std::size_t begin = 0, end = 0;
  std::size_t size() const { return end - begin; }
  bool meets(const ByteRange& other) const { return begin < other.end && other.begin < end; }
};

/// How often the file's meshes, skins and animations refer to an accessor; a number like it in an extension
/// of the file, a node, a mesh or a primitive counts as well, since it may be one.
std::size_t uses_of(const Json& root, std::size_t accessor);

/// What an accessor alone reads.
struct OwnRoom {
  /// Bytes that nothing else reads: no accessor, no picture, no extension and no buffer view that none of
  /// them uses. None of the ranges meets another.
  std::vector<ByteRange> bytes;
  std::vector<std::size_t> views;  ///< buffer views that no other accessor, picture or extension refers to
};
OwnRoom own_room(const Json& root, std::size_t accessor);

}  // namespace fascia::gltf
