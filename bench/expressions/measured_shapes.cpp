#include "bench/expressions/measured_shapes.h"

#include <cstring>
#include <nlohmann/json.hpp>

#include "formats/scene.h"
#include "geometry/error.h"

namespace fascia::bench {

namespace {

using nlohmann::json;

size_t view_start(const json& gltf, const json& part) {
  return gltf["bufferViews"][part["bufferView"].get<size_t>()].value("byteOffset", size_t{0}) +
         part.value("byteOffset", size_t{0});
}

/// A VEC3 accessor, dense or sparse, of floats or of whole numbers.
std::vector<Vec3> vectors(const json& gltf, const std::vector<uint8_t>& binary, size_t index) {
  const json& accessor = gltf["accessors"][index];
  std::vector<Vec3> values(accessor["count"].get<size_t>(), Vec3::Zero());
  const int type = accessor["componentType"];
  const bool is_normalised = accessor.value("normalized", false);
  const size_t component = type == 5126 ? 4 : type == 5122 || type == 5123 ? 2 : 1;
  const auto number = [&](size_t at) {
    if (type == 5126) {
      float value;
      std::memcpy(&value, &binary.at(at), sizeof value);
      return static_cast<double>(value);
    }
    if (type == 5122) {
      int16_t value;
      std::memcpy(&value, &binary.at(at), sizeof value);
      return is_normalised ? value / 32767.0 : value;
    }
    if (type == 5120) {
      const auto value = static_cast<int8_t>(binary.at(at));
      return is_normalised ? value / 127.0 : value;
    }
    throw Error("a morph target is of a type that is not read: " + std::to_string(type));
  };
  const auto read = [&](size_t at) {
    return Vec3(number(at), number(at + component), number(at + 2 * component));
  };
  const auto stride = [&](const json& part, size_t packed) {
    return gltf["bufferViews"][part["bufferView"].get<size_t>()].value("byteStride", packed);
  };
  if (accessor.contains("bufferView"))
    for (size_t i = 0; i < values.size(); ++i)
      values[i] = read(view_start(gltf, accessor) + stride(accessor, 3 * component) * i);
  if (accessor.contains("sparse")) {
    const json& sparse = accessor["sparse"];
    const int index_type = sparse["indices"]["componentType"];
    const size_t width = index_type == 5125 ? 4 : index_type == 5123 ? 2 : 1;
    for (size_t i = 0; i < sparse["count"].get<size_t>(); ++i) {
      uint32_t at = 0;
      std::memcpy(&at, &binary.at(view_start(gltf, sparse["indices"]) + width * i), width);
      values.at(at) = read(view_start(gltf, sparse["values"]) + 3 * component * i);
    }
  }
  return values;
}

std::vector<MeasuredShape> shapes_of(const json& gltf, const std::vector<uint8_t>& binary, const json& mesh,
                                     size_t primitive) {
  const json& source = mesh["primitives"].at(primitive);
  std::vector<MeasuredShape> shapes;
  if (!source.contains("targets")) return shapes;
  const json names =
      mesh.contains("extras") ? mesh["extras"].value("targetNames", json::array()) : json::array();
  const json& targets = source["targets"];
  for (size_t t = 0; t < targets.size() && t < names.size(); ++t)
    if (targets[t].contains("POSITION"))
      shapes.push_back({names[t], vectors(gltf, binary, targets[t]["POSITION"])});
  return shapes;
}

}  // namespace

std::vector<MeasuredShape> measured_shapes(const std::filesystem::path& path, const std::string& mesh) {
  const gltf::Document document = formats::read(path).document;
  const json gltf = json::parse(document.json);
  for (const json& entry : gltf["meshes"])
    if (entry.value("name", "") == mesh) return shapes_of(gltf, document.bin, entry, 0);
  throw Error("'" + path.string() + "' has no mesh '" + mesh + "'");
}

std::vector<MeasuredShape> measured_shapes(const std::filesystem::path& path, size_t mesh, size_t primitive) {
  const gltf::Document document = formats::read(path).document;
  const json gltf = json::parse(document.json);
  return shapes_of(gltf, document.bin, gltf["meshes"].at(mesh), primitive);
}

}  // namespace fascia::bench
