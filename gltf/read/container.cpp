#include "gltf/read/container.h"

#include <cstring>

#include "geometry/error.h"

namespace fascia::gltf {
namespace {

constexpr uint32_t magic = 0x46546C67;       // "glTF"
constexpr uint32_t json_chunk = 0x4E4F534A;  // "JSON"
constexpr uint32_t binary_chunk = 0x004E4942;
constexpr std::size_t header_size = 12, chunk_header_size = 8;

uint32_t word(std::span<const uint8_t> bytes, std::size_t at) {
  return static_cast<uint32_t>(bytes[at]) | static_cast<uint32_t>(bytes[at + 1]) << 8 |
         static_cast<uint32_t>(bytes[at + 2]) << 16 | static_cast<uint32_t>(bytes[at + 3]) << 24;
}

void put_word(std::vector<uint8_t>& bytes, uint32_t value) {
  for (int shift = 0; shift < 32; shift += 8)
    bytes.push_back(static_cast<uint8_t>(value >> shift));
}

}  // namespace

bool is_glb(std::span<const uint8_t> bytes) {
  return bytes.size() >= 4 && word(bytes, 0) == magic;
}

GlbChunks glb_chunks(std::span<const uint8_t> bytes, const std::string& name) {
  if (!is_glb(bytes)) throw Error(name + ": not a binary glTF (.glb) file");
  if (bytes.size() < header_size + chunk_header_size)
    throw Error(name + ": the file is cut short: it ends within the GLB header");
  if (word(bytes, 4) != 2)
    throw Error(name + ": glTF version " + std::to_string(word(bytes, 4)) +
                " is not supported; export glTF 2.0");
  if (word(bytes, 8) > bytes.size())
    throw Error(name + ": the file is cut short: " + std::to_string(bytes.size()) + " bytes of " +
                std::to_string(word(bytes, 8)));
  bytes = bytes.first(word(bytes, 8));
  GlbChunks chunks;
  std::size_t at = header_size;
  for (int index = 0; at < bytes.size(); ++index) {
    if (bytes.size() - at < chunk_header_size) throw Error(name + ": a GLB chunk header is cut short");
    const std::size_t length = word(bytes, at);
    const uint32_t kind = word(bytes, at + 4);
    at += chunk_header_size;
    if (length > bytes.size() - at) throw Error(name + ": a GLB chunk is longer than the file");
    if (index == 0 && kind != json_chunk) throw Error(name + ": the first GLB chunk is not JSON");
    if (index == 0)
      chunks.json = {reinterpret_cast<const char*>(bytes.data() + at), length};
    else if (index == 1 && kind == binary_chunk)
      chunks.binary = bytes.subspan(at, length);
    at += length;
  }
  if (chunks.json.empty()) throw Error(name + ": the JSON chunk is empty");
  return chunks;
}

GlbFrame glb_frame(std::string_view json, std::size_t binary_size) {
  const std::size_t json_size = (json.size() + 3) / 4 * 4, padded_size = (binary_size + 3) / 4 * 4;
  const std::size_t before =
      header_size + chunk_header_size + json_size + (binary_size == 0 ? 0 : chunk_header_size);
  if (before + padded_size > UINT32_MAX)
    throw Error("the file would be larger than the four gigabytes a GLB file can hold");
  GlbFrame frame;
  std::vector<uint8_t>& bytes = frame.before;
  bytes.reserve(before);
  put_word(bytes, magic);
  put_word(bytes, 2);
  put_word(bytes, static_cast<uint32_t>(before + padded_size));
  put_word(bytes, static_cast<uint32_t>(json_size));
  put_word(bytes, json_chunk);
  bytes.insert(bytes.end(), json.begin(), json.end());
  bytes.resize(header_size + chunk_header_size + json_size, ' ');
  if (binary_size > 0) {
    put_word(bytes, static_cast<uint32_t>(padded_size));
    put_word(bytes, binary_chunk);
  }
  frame.after.resize(padded_size - binary_size, 0);
  return frame;
}

std::vector<uint8_t> glb_bytes(std::string_view json, std::span<const uint8_t> binary) {
  GlbFrame frame = glb_frame(json, binary.size());
  std::vector<uint8_t> bytes = std::move(frame.before);
  bytes.reserve(bytes.size() + binary.size() + frame.after.size());
  bytes.insert(bytes.end(), binary.begin(), binary.end());
  bytes.insert(bytes.end(), frame.after.begin(), frame.after.end());
  return bytes;
}

}  // namespace fascia::gltf
