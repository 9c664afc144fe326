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

/// A float VEC3 accessor, dense or sparse.
std::vector<Vec3> vectors(const json& gltf, const std::vector<uint8_t>& binary, size_t index) {
  const json& accessor = gltf["accessors"][index];
  std::vector<Vec3> values(accessor["count"].get<size_t>(), Vec3::Zero());
  const auto read = [&](size_t at) {
    float xyz[3];
    std::memcpy(xyz, &binary.at(at), sizeof xyz);
    return Vec3(xyz[0], xyz[1], xyz[2]);
  };
  if (accessor.contains("bufferView"))
    for (size_t i = 0; i < values.size(); ++i)
      values[i] = read(view_start(gltf, accessor) + 12 * i);
  if (accessor.contains("sparse")) {
    const json& sparse = accessor["sparse"];
    const int type = sparse["indices"]["componentType"];
    const size_t width = type == 5125 ? 4 : type == 5123 ? 2 : 1;
    for (size_t i = 0; i < sparse["count"].get<size_t>(); ++i) {
      uint32_t at = 0;
      std::memcpy(&at, &binary.at(view_start(gltf, sparse["indices"]) + width * i), width);
      values.at(at) = read(view_start(gltf, sparse["values"]) + 12 * i);
    }
  }
  return values;
}

}  // namespace

std::vector<MeasuredShape> measured_shapes(const std::filesystem::path& path, const std::string& mesh) {
  const gltf::Document document = formats::read(path).document;
  const json gltf = json::parse(document.json);
  for (const json& entry : gltf["meshes"]) {
    if (entry.value("name", "") != mesh) continue;
    std::vector<MeasuredShape> shapes;
    const json& targets = entry["primitives"][0]["targets"];
    for (size_t t = 0; t < targets.size(); ++t)
      shapes.push_back(
          {entry["extras"]["targetNames"][t], vectors(gltf, document.bin, targets[t]["POSITION"])});
    return shapes;
  }
  throw Error("'" + path.string() + "' has no mesh '" + mesh + "'");
}

}  // namespace fascia::bench
