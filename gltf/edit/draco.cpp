#if defined(__GNUC__)
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wall"
#pragma GCC diagnostic ignored "-Wextra"
#pragma GCC diagnostic ignored "-Wshadow"
#pragma GCC diagnostic ignored "-Wpedantic"
#endif
#include <draco/compression/decode.h>
#if defined(__GNUC__)
#pragma GCC diagnostic pop
#endif

#include <algorithm>
#include <cstring>
#include <limits>
#include <map>
#include <memory>

#include "geometry/error.h"
#include "gltf/edit/decompress.h"
#include "gltf/edit/element.h"

namespace fascia::gltf {
namespace {

using Mesh = std::unique_ptr<draco::Mesh>;

std::size_t append(Json& root, std::vector<uint8_t>& bin, const void* data, std::size_t size) {
  bin.resize((bin.size() + 7) / 8 * 8, 0);
  root["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", bin.size()}, {"byteLength", size}});
  const auto* raw = static_cast<const uint8_t*>(data);
  bin.insert(bin.end(), raw, raw + size);
  return root["bufferViews"].size() - 1;
}

template <class T>
std::vector<uint8_t> values_of(const draco::Mesh& mesh, const draco::PointAttribute& attribute,
                               int components) {
  // Each element begins at a multiple of four bytes, as vertex attributes must.
  const std::size_t element = (static_cast<std::size_t>(components) * sizeof(T) + 3) / 4 * 4;
  std::vector<uint8_t> bytes(mesh.num_points() * element, 0);
  std::vector<T> value(static_cast<std::size_t>(components));
  for (uint32_t point = 0; point < mesh.num_points(); ++point) {
    if (!attribute.ConvertValue<T>(attribute.mapped_index(draco::PointIndex(point)),
                                   static_cast<int8_t>(components), value.data()))
      throw Error("an attribute cannot be converted to the accessor's type");
    std::memcpy(&bytes[point * element], value.data(), value.size() * sizeof(T));
  }
  return bytes;
}

std::vector<uint8_t> converted(const draco::Mesh& mesh, const draco::PointAttribute& attribute, int type,
                               int components) {
  switch (type) {
    case 5120:
      return values_of<int8_t>(mesh, attribute, components);
    case 5121:
      return values_of<uint8_t>(mesh, attribute, components);
    case 5122:
      return values_of<int16_t>(mesh, attribute, components);
    case 5123:
      return values_of<uint16_t>(mesh, attribute, components);
    case 5125:
      return values_of<uint32_t>(mesh, attribute, components);
    case 5126:
      return values_of<float>(mesh, attribute, components);
    default:
      throw Error("an accessor has the unknown component type " + std::to_string(type));
  }
}

/// Quantisation moves the extremes, and POSITION must state them.
void set_bounds(Json& accessor, const std::vector<uint8_t>& bytes) {
  std::array<float, 3> low, high;
  low.fill(std::numeric_limits<float>::max());
  high.fill(std::numeric_limits<float>::lowest());
  for (std::size_t i = 0; i + 12 <= bytes.size(); i += 12)
    for (std::size_t k = 0; k < 3; ++k) {
      float value;
      std::memcpy(&value, &bytes[i + 4 * k], sizeof value);
      low[k] = std::min(low[k], value);
      high[k] = std::max(high[k], value);
    }
  accessor["min"] = low;
  accessor["max"] = high;
}

void unpack_attribute(Json& root, std::vector<uint8_t>& bin, const draco::Mesh& mesh, const std::string& name,
                      std::size_t index, uint32_t id) {
  Json& accessor = root.at("accessors").at(index);
  const draco::PointAttribute* attribute = mesh.GetAttributeByUniqueId(id);
  const auto components = static_cast<int>(components_of(accessor.at("type")));
  if (attribute == nullptr || components == 0) throw Error("attribute " + name + " is not in its data");
  const int type = accessor.at("componentType");
  const std::vector<uint8_t> bytes = converted(mesh, *attribute, type, components);
  const std::size_t view = append(root, bin, bytes.data(), bytes.size());
  if (mesh.num_points() > 0 && bytes.size() / mesh.num_points() != static_cast<std::size_t>(components) * 4)
    root["bufferViews"][view]["byteStride"] = bytes.size() / mesh.num_points();
  accessor["bufferView"] = view;
  accessor["count"] = mesh.num_points();
  accessor.erase("byteOffset");
  if (name == "POSITION" && type == 5126 && components == 3) set_bounds(accessor, bytes);
}

void unpack_indices(Json& root, std::vector<uint8_t>& bin, const draco::Mesh& mesh, Json& primitive) {
  std::vector<uint32_t> indices;
  for (uint32_t face = 0; face < mesh.num_faces(); ++face)
    for (int corner = 0; corner < 3; ++corner)
      indices.push_back(mesh.face(draco::FaceIndex(face))[static_cast<std::size_t>(corner)].value());
  const std::size_t view = append(root, bin, indices.data(), indices.size() * sizeof(uint32_t));
  Json accessor = {
      {"bufferView", view}, {"componentType", 5125}, {"count", indices.size()}, {"type", "SCALAR"}};
  if (primitive.contains("indices")) {
    root.at("accessors").at(primitive["indices"].get<std::size_t>()) = std::move(accessor);
  } else {
    root["accessors"].push_back(std::move(accessor));
    primitive["indices"] = root["accessors"].size() - 1;
  }
  primitive["mode"] = 4;
}

Mesh decoded(const Json& root, const std::vector<uint8_t>& bin, std::size_t view_index) {
  const Json& view = root.at("bufferViews").at(view_index);
  const std::size_t begin = view.value("byteOffset", std::size_t{0}), length = view.at("byteLength");
  if (begin > bin.size() || length > bin.size() - begin)
    throw Error("its compressed data reach beyond the buffer: the file is truncated");
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bin.data()) + begin, length);
  draco::Decoder decoder;
  auto mesh = decoder.DecodeMeshFromBuffer(&buffer);
  if (!mesh.ok()) throw Error("its compressed data are damaged (" + mesh.status().error_msg_string() + ")");
  return std::move(mesh).value();
}

}  // namespace

void undo_draco(Json& root, std::vector<uint8_t>& bin) {
  std::map<std::size_t, Mesh> meshes;  // by buffer view: copies of a primitive share theirs
  for (std::size_t m = 0; root.contains("meshes") && m < root["meshes"].size(); ++m)
    for (std::size_t p = 0; p < root["meshes"][m].at("primitives").size(); ++p) {
      Json primitive = root["meshes"][m]["primitives"][p];
      if (!primitive.contains("extensions") || !primitive["extensions"].contains(draco_extension)) continue;
      try {
        const Json packing = primitive["extensions"][draco_extension];
        const auto view = packing.at("bufferView").get<std::size_t>();
        const auto [mesh, is_new] = meshes.try_emplace(view);
        if (is_new) mesh->second = decoded(root, bin, view);
        for (const auto& [name, id] : packing.at("attributes").items())
          unpack_attribute(root, bin, *mesh->second, name, primitive.at("attributes").at(name),
                           id.get<uint32_t>());
        unpack_indices(root, bin, *mesh->second, primitive);
      } catch (const Error& error) {
        throw Error("mesh " + std::to_string(m) + " primitive " + std::to_string(p) + " (" + draco_extension +
                    "): " + error.what() + "; save the file without compression and try again");
      }
      primitive["extensions"].erase(draco_extension);
      if (primitive["extensions"].empty()) primitive.erase("extensions");
      root["meshes"][m]["primitives"][p] = std::move(primitive);
    }
  // The compressed bytes go; their views stay, so that no index of the file moves.
  for (const auto& [view, mesh] : meshes) {
    Json& emptied = root["bufferViews"][view];
    emptied["byteLength"] = 1;
    emptied.erase("target");
  }
  forget_extension(root, draco_extension);
}

}  // namespace fascia::gltf
