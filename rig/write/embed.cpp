#include <cctype>
#include <nlohmann/json.hpp>

#include "geometry/error.h"
#include "rig/read/container.h"
#include "rig/write/write.h"

namespace fascia::rig {
namespace {

using Json = nlohmann::ordered_json;

int base64_digit(char c) {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  if (c == '+' || c == '-') return 62;
  if (c == '/' || c == '_') return 63;
  return -1;
}

std::vector<uint8_t> base64_bytes(std::string_view text) {
  std::vector<uint8_t> bytes;
  uint32_t bits = 0;
  int held = 0;
  for (const char c : text) {
    const int digit = base64_digit(c);
    if (digit < 0) continue;
    bits = bits << 6 | static_cast<uint32_t>(digit);
    held += 6;
    if (held >= 8) {
      held -= 8;
      bytes.push_back(static_cast<uint8_t>(bits >> held));
    }
  }
  return bytes;
}

std::string percent_decoded(const std::string& uri) {
  std::string text;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    if (uri[i] == '%' && i + 2 < uri.size() && std::isxdigit(static_cast<unsigned char>(uri[i + 1])) &&
        std::isxdigit(static_cast<unsigned char>(uri[i + 2]))) {
      text.push_back(static_cast<char>(std::stoi(uri.substr(i + 1, 2), nullptr, 16)));
      i += 2;
    } else {
      text.push_back(uri[i]);
    }
  }
  return text;
}

/// Content and media type of a data URI; nothing when `uri` is none or not in base 64.
std::optional<std::pair<std::vector<uint8_t>, std::string>> data_uri(const std::string& uri) {
  if (uri.rfind("data:", 0) != 0) return std::nullopt;
  const std::size_t comma = uri.find(',');
  const std::string marker = ";base64";
  if (comma == std::string::npos || comma < 5 + marker.size() ||
      uri.compare(comma - marker.size(), marker.size(), marker) != 0)
    throw Error("a data URI in the glTF file is not base 64");
  return std::make_pair(base64_bytes(std::string_view(uri).substr(comma + 1)),
                        uri.substr(5, uri.find_first_of(";,") - 5));
}

std::vector<uint8_t> buffer_bytes(const GltfSource& source, const Json& buffer, std::size_t index) {
  const std::string name = "buffer " + std::to_string(index);
  const std::size_t length = buffer.at("byteLength").get<std::size_t>();
  std::vector<uint8_t> bytes;
  if (!buffer.contains("uri")) {
    if (index != 0)
      throw Error(name +
                  " has no data of its own (EXT_meshopt_compression?); decompress the file, "
                  "for instance with `gltf-transform copy`, and try again");
    bytes = source.bin;
  } else {
    const auto uri = buffer["uri"].get<std::string>();
    if (auto data = data_uri(uri)) {
      bytes = std::move(data->first);
    } else {
      auto file = source.resolve ? source.resolve(percent_decoded(uri)) : std::nullopt;
      if (!file)
        throw Error(name + ": the file " + uri + " it names cannot be read; put it beside the glTF file");
      bytes = std::move(*file);
    }
  }
  if (bytes.size() < length)
    throw Error(name + " is cut short: " + std::to_string(bytes.size()) + " bytes of " +
                std::to_string(length));
  bytes.resize(length);
  return bytes;
}

/// Lays all buffers end to end and points the buffer views there.
std::vector<uint8_t> join_buffers(const GltfSource& source, Json& root) {
  std::vector<uint8_t> bin;
  if (!root.contains("buffers") || root["buffers"].empty()) return bin;
  std::vector<std::size_t> begins;
  for (std::size_t i = 0; i < root["buffers"].size(); ++i) {
    bin.resize((bin.size() + 7) / 8 * 8, 0);
    begins.push_back(bin.size());
    const std::vector<uint8_t> bytes = buffer_bytes(source, root["buffers"][i], i);
    bin.insert(bin.end(), bytes.begin(), bytes.end());
  }
  if (root.contains("bufferViews"))
    for (Json& view : root["bufferViews"]) {
      const auto buffer = view.at("buffer").get<std::size_t>();
      if (buffer >= begins.size())
        throw Error("a buffer view names buffer " + std::to_string(buffer) + ", which does not exist");
      if (buffer == 0) continue;
      view["byteOffset"] = view.value("byteOffset", std::size_t{0}) + begins[buffer];
      view["buffer"] = 0;
    }
  Json first = root["buffers"][0];
  first.erase("uri");
  first["byteLength"] = bin.size();
  root["buffers"] = Json::array({std::move(first)});
  return bin;
}

std::string media_type(const std::vector<uint8_t>& image) {
  if (image.size() > 3 && image[0] == 0x89 && image[1] == 'P') return "image/png";
  if (image.size() > 3 && image[0] == 0xFF && image[1] == 0xD8) return "image/jpeg";
  return "";
}

/// Takes the image files beside the glTF file into its binary chunk, PNG and JPEG ones.
void embed_images(const GltfSource& source, Json& root, std::vector<uint8_t>& bin) {
  if (!root.contains("images") || !source.resolve) return;
  for (Json& image : root["images"]) {
    if (!image.contains("uri") || image["uri"].get<std::string>().rfind("data:", 0) == 0) continue;
    const auto bytes = source.resolve(percent_decoded(image["uri"].get<std::string>()));
    if (!bytes || media_type(*bytes).empty()) continue;
    bin.resize((bin.size() + 7) / 8 * 8, 0);
    if (!root.contains("bufferViews")) root["bufferViews"] = Json::array();
    root["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", bin.size()}, {"byteLength", bytes->size()}});
    bin.insert(bin.end(), bytes->begin(), bytes->end());
    image.erase("uri");
    image["bufferView"] = root["bufferViews"].size() - 1;
    image["mimeType"] = media_type(*bytes);
  }
  if (bin.empty()) return;
  if (!root.contains("buffers")) root["buffers"] = Json::array({Json::object()});
  root["buffers"][0]["byteLength"] = bin.size();
}

}  // namespace

GltfSource glb_source(std::span<const uint8_t> bytes, const std::string& name) {
  const GlbChunks chunks = glb_chunks(bytes, name);
  GltfSource source;
  source.json = chunks.json;
  source.bin.assign(chunks.binary.begin(), chunks.binary.end());
  return source;
}

GltfSource embed(const GltfSource& source) {
  try {
    Json root = Json::parse(source.json);
    if (!root.is_object()) throw Error("the glTF file's JSON is not an object");
    GltfSource result;
    result.record = source.record;
    result.bin = join_buffers(source, root);
    embed_images(source, root, result.bin);
    result.json = root.dump();
    return result;
  } catch (const nlohmann::json::exception& exception) {
    throw Error(std::string("the glTF file's JSON is malformed: ") + exception.what());
  }
}

}  // namespace fascia::rig
