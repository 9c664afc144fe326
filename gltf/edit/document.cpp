#include "gltf/edit/document.h"

#include <algorithm>
#include <map>

#include "geometry/error.h"
#include "geometry/json.h"
#include "gltf/edit/decompress.h"
#include "gltf/edit/uri.h"
#include "gltf/edit/whole_numbers.h"
#include "gltf/read/container.h"
#include "gltf/read/text.h"

namespace fascia::gltf {
namespace {

std::size_t length_of(const Json& root, const char* name) {
  return root.contains(name) ? root[name].size() : 0;
}

void align(std::vector<uint8_t>& bin) {
  bin.resize((bin.size() + 7) / 8 * 8, 0);
}

/// A buffer that stands for what its views unpack to (EXT_meshopt_compression, "fallback buffers").
bool is_placeholder(const Json& buffer) {
  if (buffer.contains("uri") || !buffer.contains("extensions")) return false;
  const Json& extensions = buffer["extensions"];
  return extensions.contains(meshopt_extension) && extensions[meshopt_extension].value("fallback", false);
}

OutsideFile opened(const std::string& uri, const Resolver& resolve) {
  if (has_scheme(uri)) return {std::nullopt, "is not a file beside it; download it and name the copy"};
  if (!resolve) return {std::nullopt, "cannot be read from here"};
  return resolve(percent_decoded(uri));
}

std::vector<uint8_t> buffer_bytes(const Document& document, const Resolver& resolve, const Json& buffer,
                                  std::size_t index) {
  const std::string name = "buffer " + std::to_string(index);
  const auto length = buffer.at("byteLength").get<std::size_t>();
  std::vector<uint8_t> bytes;
  if (!buffer.contains("uri")) {
    if (index != 0) throw Error(name + " has no data");
    bytes = document.bin;
  } else {
    const auto uri = buffer["uri"].get<std::string>();
    if (auto data = data_uri(uri)) {
      bytes = std::move(data->bytes);
    } else {
      OutsideFile file = opened(uri, resolve);
      if (!file.bytes) throw Error(name + ": the file '" + uri + "' it names " + file.why);
      bytes = std::move(*file.bytes);
    }
  }
  if (bytes.size() < length)
    throw Error(name + " is cut short: " + std::to_string(bytes.size()) + " bytes of " +
                std::to_string(length) + ": the file is truncated");
  bytes.resize(length);
  return bytes;
}

/// Points one reference to a range of a buffer at the joined one.
void repoint(Json& range, const std::vector<std::size_t>& begins) {
  const auto buffer = range.at("buffer").get<std::size_t>();
  if (buffer >= begins.size())
    throw Error("a buffer view names buffer " + std::to_string(buffer) + ", which does not exist");
  if (buffer == 0) return;
  range["byteOffset"] = range.value("byteOffset", std::size_t{0}) + begins[buffer];
  range["buffer"] = 0;
}

/// Lays all buffers end to end and points the buffer views there.
std::vector<uint8_t> join_buffers(const Document& document, const Resolver& resolve, Json& root) {
  std::vector<uint8_t> bin;
  std::vector<std::size_t> begins;
  for (std::size_t i = 0; i < length_of(root, "buffers"); ++i) {
    align(bin);
    begins.push_back(bin.size());
    if (is_placeholder(root["buffers"][i])) continue;
    const std::vector<uint8_t> bytes = buffer_bytes(document, resolve, root["buffers"][i], i);
    bin.insert(bin.end(), bytes.begin(), bytes.end());
  }
  for (std::size_t i = 0; i < length_of(root, "bufferViews"); ++i) {
    Json& view = root["bufferViews"][i];
    repoint(view, begins);
    if (view.contains("extensions") && view["extensions"].contains(meshopt_extension))
      repoint(view["extensions"][meshopt_extension], begins);
  }
  if (begins.empty()) return bin;
  Json first = root["buffers"][0];
  first.erase("uri");
  if (is_placeholder(first)) first.erase("extensions");
  root["buffers"] = Json::array({std::move(first)});
  return bin;
}

std::string media_type(const std::vector<uint8_t>& bytes, const Json& image, const std::string& declared,
                       const std::string& uri) {
  const std::string type = picture_type(bytes);
  if (!type.empty()) return type;
  if (image.contains("mimeType")) return image["mimeType"].get<std::string>();
  return !declared.empty() ? declared : picture_type_of_name(uri);
}

/// Takes the pictures that have a URI into the binary chunk; one that cannot be had keeps it.
void take_in_pictures(const Resolver& resolve, Json& root, std::vector<uint8_t>& bin,
                      std::vector<std::string>& warnings) {
  std::map<std::string, std::size_t> views;
  for (std::size_t i = 0; i < length_of(root, "images"); ++i) {
    const Json image = root["images"][i];
    if (!image.contains("uri")) continue;
    const auto uri = image["uri"].get<std::string>();
    auto data = data_uri(uri);
    OutsideFile file = data ? OutsideFile{std::move(data->bytes), ""} : opened(uri, resolve);
    if (!file.bytes) {
      warnings.push_back("picture " + std::to_string(i) + " ('" + uri + "') " + file.why +
                         "; it stays as named");
      continue;
    }
    const std::string type = media_type(*file.bytes, image, data ? data->media_type : "", uri);
    if (type.empty()) {
      warnings.push_back("picture " + std::to_string(i) + " ('" + uri.substr(0, 60) +
                         "') is of a kind that is not known; it stays as named");
      continue;
    }
    const auto [entry, is_new] = views.try_emplace(uri, length_of(root, "bufferViews"));
    if (is_new) {
      align(bin);
      if (!root.contains("bufferViews")) root["bufferViews"] = Json::array();
      root["bufferViews"].push_back(
          {{"buffer", 0}, {"byteOffset", bin.size()}, {"byteLength", file.bytes->size()}});
      bin.insert(bin.end(), file.bytes->begin(), file.bytes->end());
    }
    // Fetched anew: a property added to an ordered object moves the others.
    Json& held = root["images"][i];
    held.erase("uri");
    held["bufferView"] = entry->second;
    held["mimeType"] = type;
  }
}

/// Drops the bytes that no view shows, such as compressed data that have been unpacked.
std::vector<uint8_t> packed(Json& root, const std::vector<uint8_t>& bin) {
  std::vector<uint8_t> result;
  std::map<std::pair<std::size_t, std::size_t>, std::size_t> places;
  for (Json& view : root["bufferViews"]) {
    const std::size_t begin = view.value("byteOffset", std::size_t{0}), length = view.at("byteLength");
    if (begin > bin.size() || length > bin.size() - begin)
      throw Error("a buffer view reaches beyond its buffer");
    align(result);
    const auto [place, is_new] = places.try_emplace({begin, length}, result.size());
    if (is_new)
      result.insert(result.end(), bin.begin() + static_cast<std::ptrdiff_t>(begin),
                    bin.begin() + static_cast<std::ptrdiff_t>(begin + length));
    view["byteOffset"] = place->second;
  }
  return result;
}

bool is_whole(const Document& document, const Json& root) {
  for (const Json& image : root.value("images", Json::array()))
    if (image.contains("uri")) return false;
  const std::size_t buffers = length_of(root, "buffers");
  if (buffers == 0) return true;
  return buffers == 1 && !root["buffers"][0].contains("uri") && !is_compressed(root) &&
         document.bin.size() >= root["buffers"][0].at("byteLength").get<std::size_t>();
}

Document joined(const Document& document, Json root, const Resolver& resolve,
                std::vector<std::string>& warnings) {
  Document result;
  result.bin = join_buffers(document, resolve, root);
  if (is_compressed(root)) {
    undo_meshopt(root, result.bin);
    undo_draco(root, result.bin);
    result.bin = packed(root, result.bin);
  }
  take_in_pictures(resolve, root, result.bin, warnings);
  if (!result.bin.empty()) {
    if (!root.contains("buffers")) root["buffers"] = Json::array({Json::object()});
    root["buffers"][0]["byteLength"] = result.bin.size();
  }
  result.json = text_of(root);
  return result;
}

}  // namespace

Document glb_document(std::span<const uint8_t> bytes, const std::string& name) {
  const GlbChunks chunks = glb_chunks(bytes, name);
  return {std::string(chunks.json), {chunks.binary.begin(), chunks.binary.end()}};
}

Json parsed(const std::string& json, const std::string& name, bool* repaired) {
  check_depth(json, name);
  try {
    const bool is_sound = is_utf8(json);
    if (repaired != nullptr) *repaired = !is_sound;
    Json root = is_sound ? Json::parse(json) : Json::parse(as_utf8(json));
    if (!root.is_object()) throw Error(name + ": the glTF file's JSON is not an object");
    return root;
  } catch (const nlohmann::json::exception& exception) {
    throw Error(name + ": the glTF file's JSON is damaged: " + exception.what());
  }
}

std::string text_of(const Json& json) {
  return json.dump(-1, ' ', false, Json::error_handler_t::replace);
}

Document self_contained(Document document, const Resolver& resolve, const std::string& name,
                        std::vector<std::string>* warnings) {
  std::vector<std::string> unheard;
  std::vector<std::string>& heard = warnings != nullptr ? *warnings : unheard;
  bool repaired = false;
  Json root = parsed(document.json, name, &repaired);
  if (repaired) heard.push_back("the glTF file's JSON is not UTF-8; names in it were read as Latin-1");
  try {
    const bool has_decimals = make_whole_numbers(root);
    if (!repaired && !has_decimals && is_whole(document, root)) return document;
    return joined(document, std::move(root), resolve, heard);
  } catch (const nlohmann::json::exception& exception) {
    throw Error(name + ": the glTF file's JSON is malformed: " + exception.what());
  } catch (const Error& error) {
    throw Error(name + ": " + error.what());
  }
}

}  // namespace fascia::gltf
