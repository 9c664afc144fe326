#include <meshoptimizer.h>

#include <algorithm>

#include "geometry/error.h"
#include "gltf/edit/decompress.h"

namespace fascia::gltf {
namespace {

struct Packed {
  std::span<const uint8_t> bytes;
  std::size_t stride = 0, count = 0;
  std::string mode, filter;
};

/// The compressed range of a view, checked against `bin` and against what each codec can hold at most.
Packed packed_range(const Json& packing, const std::vector<uint8_t>& bin, const std::string& name) {
  Packed packed;
  const std::size_t begin = packing.value("byteOffset", std::size_t{0}), length = packing.at("byteLength");
  if (begin > bin.size() || length > bin.size() - begin)
    throw Error(name + ": its compressed data reach beyond the buffer: the file is truncated");
  packed.bytes = std::span(bin).subspan(begin, length);
  packed.stride = packing.at("byteStride");
  packed.count = packing.at("count");
  packed.mode = packing.at("mode");
  packed.filter = packing.value("filter", "NONE");
  const bool vertices = packed.mode == "ATTRIBUTES";
  if (vertices ? packed.stride == 0 || packed.stride > 256 || packed.stride % 4 != 0
               : packed.stride != 2 && packed.stride != 4)
    throw Error(name + ": a stride of " + std::to_string(packed.stride) + " bytes cannot be compressed");
  // A vertex takes at least two bits for sixteen bytes of it, a triangle or an index a byte (meshoptimizer,
  // "codec").
  const std::size_t most = vertices ? 64 * length / packed.stride : 3 * length;
  if (packed.count > most)
    throw Error(name + ": it promises " + std::to_string(packed.count) + " elements in " +
                std::to_string(length) + " bytes: the file is damaged");
  return packed;
}

int decode(const Packed& packed, void* to) {
  const auto* from = packed.bytes.data();
  const std::size_t size = packed.bytes.size();
  if (packed.mode == "ATTRIBUTES")
    return meshopt_decodeVertexBuffer(to, packed.count, packed.stride, from, size);
  if (packed.mode == "TRIANGLES")
    return packed.count % 3 == 0 ? meshopt_decodeIndexBuffer(to, packed.count, packed.stride, from, size)
                                 : -1;
  if (packed.mode == "INDICES")
    return meshopt_decodeIndexSequence(to, packed.count, packed.stride, from, size);
  return -1;
}

bool unfilter(const Packed& packed, void* data) {
  if (packed.filter == "NONE") return true;
  if (packed.filter == "OCTAHEDRAL" && (packed.stride == 4 || packed.stride == 8))
    meshopt_decodeFilterOct(data, packed.count, packed.stride);
  else if (packed.filter == "QUATERNION" && packed.stride == 8)
    meshopt_decodeFilterQuat(data, packed.count, packed.stride);
  else if (packed.filter == "EXPONENTIAL" && packed.stride % 4 == 0)
    meshopt_decodeFilterExp(data, packed.count, packed.stride);
  else
    return false;
  return true;
}

}  // namespace

void undo_meshopt(Json& root, std::vector<uint8_t>& bin) {
  if (!root.contains("bufferViews")) return;
  for (std::size_t i = 0; i < root["bufferViews"].size(); ++i) {
    Json& view = root["bufferViews"][i];
    if (!view.contains("extensions") || !view["extensions"].contains(meshopt_extension)) continue;
    const std::string name = "buffer view " + std::to_string(i) + " (EXT_meshopt_compression)";
    const Packed packed = packed_range(view["extensions"][meshopt_extension], bin, name);
    std::vector<uint8_t> plain(packed.count * packed.stride);
    if (packed.count > 0 && (decode(packed, plain.data()) != 0 || !unfilter(packed, plain.data())))
      throw Error(name + ": its data are damaged or of an unknown mode; save the file without compression");
    bin.resize((bin.size() + 7) / 8 * 8, 0);
    view["byteOffset"] = bin.size();
    view["byteLength"] = plain.size();
    bin.insert(bin.end(), plain.begin(), plain.end());
    view["extensions"].erase(meshopt_extension);
    if (view["extensions"].empty()) view.erase("extensions");
  }
  forget_extension(root, meshopt_extension);
}

bool is_compressed(const Json& root) {
  const Json used = root.value("extensionsUsed", Json::array());
  for (const char* name : {meshopt_extension, draco_extension})
    if (std::find(used.begin(), used.end(), name) != used.end()) return true;
  for (const Json& view : root.value("bufferViews", Json::array()))
    if (view.contains("extensions") && view["extensions"].contains(meshopt_extension)) return true;
  for (const Json& mesh : root.value("meshes", Json::array()))
    for (const Json& primitive : mesh.value("primitives", Json::array()))
      if (primitive.contains("extensions") && primitive["extensions"].contains(draco_extension)) return true;
  return false;
}

void forget_extension(Json& root, const std::string& extension) {
  for (const char* list : {"extensionsUsed", "extensionsRequired"}) {
    if (!root.contains(list)) continue;
    Json& names = root[list];
    names.erase(std::remove(names.begin(), names.end(), Json(extension)), names.end());
    if (names.empty()) root.erase(list);
  }
}

}  // namespace fascia::gltf
