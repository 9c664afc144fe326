#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace fascia::gltf {

/// The two chunks of a GLB file, as views into its bytes.
struct GlbChunks {
  std::string_view json;
  std::span<const uint8_t> binary;  ///< empty when the file has no binary chunk
};

/// True when `bytes` begin like a GLB file.
bool is_glb(std::span<const uint8_t> bytes);

/// Takes a GLB file apart (glTF 2.0, section 4.4). Throws fascia::Error naming `name` when the header, a
/// chunk's length or a chunk's kind is wrong or the file is shorter than it says.
GlbChunks glb_chunks(std::span<const uint8_t> bytes, const std::string& name);

/// Puts a GLB file together: JSON padded with spaces, the binary chunk with zeros and left out when empty.
/// Throws fascia::Error when the file would pass the format's four gigabytes.
std::vector<uint8_t> glb_bytes(std::string_view json, std::span<const uint8_t> binary);

/// The same without the binary chunk's bytes: what stands before and behind `binary_size` of them, for files
/// that are not to be in memory twice.
struct GlbFrame {
  std::vector<uint8_t> before, after;
};
GlbFrame glb_frame(std::string_view json, std::size_t binary_size);

}  // namespace fascia::gltf
