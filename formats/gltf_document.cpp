#include "formats/gltf_document.h"

#include <cstring>
#include <nlohmann/json.hpp>

#include "geometry/error.h"

namespace fascia::formats {

namespace {

using Json = nlohmann::ordered_json;

constexpr uint32_t json_chunk = 0x4E4F534A, binary_chunk = 0x004E4942;

[[noreturn]] void fail(const std::filesystem::path& path, const std::string& what) {
  throw Error("'" + path.string() + "': " + what);
}

uint32_t word_at(const std::vector<uint8_t>& bytes, size_t at) {
  uint32_t value;
  std::memcpy(&value, &bytes[at], 4);
  return value;
}

GltfDocument split_glb(const std::filesystem::path& path, const std::vector<uint8_t>& bytes) {
  if (bytes.size() < 20) fail(path, "its GLB header is not whole: the file is truncated");
  if (word_at(bytes, 4) != 2)
    fail(path, "it is glTF version " + std::to_string(word_at(bytes, 4)) + "; only 2 is read");
  if (word_at(bytes, 8) > bytes.size())
    fail(path, "its GLB header promises " + std::to_string(word_at(bytes, 8)) + " bytes, the file has " +
                   std::to_string(bytes.size()) + ": it is truncated");
  GltfDocument document;
  size_t at = 12;
  while (at + 8 <= bytes.size()) {
    const size_t size = word_at(bytes, at), type = word_at(bytes, at + 4);
    if (at + 8 + size > bytes.size()) fail(path, "a GLB chunk reaches past the end: the file is truncated");
    const auto begin = bytes.begin() + static_cast<std::ptrdiff_t>(at + 8);
    if (type == json_chunk && document.json.empty())
      document.json.assign(begin, begin + static_cast<std::ptrdiff_t>(size));
    if (type == binary_chunk && document.binary.empty())
      document.binary.assign(begin, begin + static_cast<std::ptrdiff_t>(size));
    at += 8 + (size + 3) / 4 * 4;
  }
  return document;
}

/// RFC 4648; characters outside the alphabet are passed over.
std::vector<uint8_t> base64_bytes(const std::string& text) {
  static const std::string alphabet = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<uint8_t> bytes;
  uint32_t window = 0;
  int bits = 0;
  for (char c : text) {
    const size_t value = alphabet.find(c);
    if (value == std::string::npos) continue;
    window = window << 6 | static_cast<uint32_t>(value);
    bits += 6;
    if (bits < 8) continue;
    bits -= 8;
    bytes.push_back(static_cast<uint8_t>(window >> bits & 0xFF));
  }
  return bytes;
}

std::vector<uint8_t> resolve_uri(const std::filesystem::path& path, const std::string& uri) {
  if (uri.rfind("data:", 0) == 0) {
    const size_t comma = uri.find(',');
    if (comma == std::string::npos || uri.find(";base64") > comma)
      fail(path, "it has a data URI that is not base64");
    return base64_bytes(uri.substr(comma + 1));
  }
  std::string plain;
  for (size_t i = 0; i < uri.size(); ++i) {
    if (uri[i] == '%' && i + 2 < uri.size()) {
      plain.push_back(static_cast<char>(std::strtol(uri.substr(i + 1, 2).c_str(), nullptr, 16)));
      i += 2;
    } else {
      plain.push_back(uri[i]);
    }
  }
  const std::filesystem::path beside = path.parent_path() / std::filesystem::path(plain);
  if (!std::filesystem::exists(beside))
    fail(path, "it names the file '" + plain + "', which is not beside it");
  return read_bytes(beside);
}

size_t append(std::vector<uint8_t>& binary, const std::vector<uint8_t>& bytes) {
  binary.resize((binary.size() + 3) / 4 * 4);
  const size_t offset = binary.size();
  binary.insert(binary.end(), bytes.begin(), bytes.end());
  return offset;
}

void bring_in_buffers(const std::filesystem::path& path, Json& json, std::vector<uint8_t>& binary) {
  if (!json.contains("buffers")) return;
  std::vector<size_t> offsets;
  for (size_t i = 0; i < json["buffers"].size(); ++i) {
    const Json& buffer = json["buffers"][i];
    const size_t promised = buffer.value("byteLength", size_t{0});
    size_t offset = 0, size = binary.size();
    if (buffer.contains("uri")) {
      const std::vector<uint8_t> bytes = resolve_uri(path, buffer["uri"].get<std::string>());
      size = bytes.size();
      offset = append(binary, bytes);
    } else if (i != 0) {
      fail(path, "buffer " + std::to_string(i) + " has no data");
    }
    if (size < promised)
      fail(path, "buffer " + std::to_string(i) + " should have " + std::to_string(promised) +
                     " bytes and has " + std::to_string(size) + ": the file is truncated");
    offsets.push_back(offset);
  }
  if (json.contains("bufferViews"))
    for (Json& view : json["bufferViews"]) {
      const size_t buffer = view.value("buffer", size_t{0});
      if (buffer >= offsets.size())
        fail(path, "a bufferView names buffer " + std::to_string(buffer) + ", which is not there");
      if (buffer != 0 || offsets[0] != 0) {
        view["byteOffset"] = view.value("byteOffset", size_t{0}) + offsets[buffer];
        view["buffer"] = 0;
      }
    }
}

void bring_in_images(const std::filesystem::path& path, Json& json, std::vector<uint8_t>& binary) {
  if (!json.contains("images")) return;
  for (Json& image : json["images"]) {
    if (!image.contains("uri")) continue;
    const std::string uri = image["uri"].get<std::string>();
    const std::vector<uint8_t> bytes = resolve_uri(path, uri);
    const bool is_png = bytes.size() > 3 && bytes[0] == 0x89 && bytes[1] == 'P';
    if (!image.contains("mimeType")) image["mimeType"] = is_png ? "image/png" : "image/jpeg";
    image.erase("uri");
    image["bufferView"] = json.contains("bufferViews") ? json["bufferViews"].size() : 0;
    const size_t offset = append(binary, bytes);
    json["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", offset}, {"byteLength", bytes.size()}});
  }
}

}  // namespace

GltfDocument gltf_document(const std::filesystem::path& path, const std::vector<uint8_t>& bytes) {
  const bool is_glb = bytes.size() >= 4 && std::memcmp(bytes.data(), "glTF", 4) == 0;
  GltfDocument document = is_glb ? split_glb(path, bytes) : GltfDocument{{bytes.begin(), bytes.end()}, {}};
  try {
    Json json = Json::parse(document.json);
    if (!json.is_object() || !json.contains("asset"))
      fail(path, "it is JSON, but not glTF: 'asset' is missing");
    const bool is_whole = json.contains("buffers") && json["buffers"].size() == 1 &&
                          !json["buffers"][0].contains("uri") &&
                          document.binary.size() >= json["buffers"][0].value("byteLength", size_t{0});
    bool has_outside_images = false;
    if (json.contains("images"))
      for (const Json& image : json["images"])
        has_outside_images |= image.contains("uri");
    if (is_whole && !has_outside_images) return document;
    bring_in_buffers(path, json, document.binary);
    bring_in_images(path, json, document.binary);
    document.binary.resize((document.binary.size() + 3) / 4 * 4);
    if (!document.binary.empty()) {
      json["buffers"] = Json::array({{{"byteLength", document.binary.size()}}});
    }
    document.json = json.dump();
  } catch (const nlohmann::json::exception& error) {
    fail(path, std::string("its glTF JSON is damaged: ") + error.what());
  }
  return document;
}

std::vector<uint8_t> glb_bytes(const GltfDocument& document) {
  std::string json = document.json;
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const size_t binary_size = (document.binary.size() + 3) / 4 * 4;
  const size_t total = 12 + 8 + json.size() + (binary_size ? 8 + binary_size : 0);
  std::vector<uint8_t> bytes;
  bytes.reserve(total);
  const auto word = [&](size_t value) {
    const uint32_t narrow = static_cast<uint32_t>(value);
    const auto* raw = reinterpret_cast<const uint8_t*>(&narrow);
    bytes.insert(bytes.end(), raw, raw + 4);
  };
  bytes.insert(bytes.end(), {'g', 'l', 'T', 'F'});
  word(2);
  word(total);
  word(json.size());
  word(json_chunk);
  bytes.insert(bytes.end(), json.begin(), json.end());
  if (binary_size) {
    word(binary_size);
    word(binary_chunk);
    bytes.insert(bytes.end(), document.binary.begin(), document.binary.end());
    bytes.resize(total, 0);
  }
  return bytes;
}

}  // namespace fascia::formats
