#include "builder/rigging/gltf_source.h"

#include <cstring>
#include <nlohmann/json.hpp>

namespace fascia::rigging {

namespace {

using Json = nlohmann::ordered_json;

/// Collects the buffer of a made glTF.
class Buffer {
 public:
  size_t add(Json& json, const void* data, size_t size, int target, int component, const char* type,
             size_t count) {
    bytes.resize((bytes.size() + 3) / 4 * 4);
    json["bufferViews"].push_back(
        {{"buffer", 0}, {"byteOffset", bytes.size()}, {"byteLength", size}, {"target", target}});
    const auto* raw = static_cast<const uint8_t*>(data);
    bytes.insert(bytes.end(), raw, raw + size);
    json["accessors"].push_back({{"bufferView", json["bufferViews"].size() - 1},
                                 {"componentType", component},
                                 {"count", count},
                                 {"type", type}});
    return json["accessors"].size() - 1;
  }

  std::vector<uint8_t> bytes;
};

size_t add_positions(Json& json, Buffer& buffer, const std::vector<Vec3>& positions) {
  std::vector<float> values;
  Eigen::Vector3f low = Eigen::Vector3f::Constant(3e38F), high = -low;
  for (const Vec3& p : positions) {
    const Eigen::Vector3f q = p.cast<float>();
    values.insert(values.end(), q.data(), q.data() + 3);
    low = low.cwiseMin(q);
    high = high.cwiseMax(q);
  }
  const size_t accessor =
      buffer.add(json, values.data(), values.size() * 4, 34962, 5126, "VEC3", positions.size());
  json["accessors"][accessor]["min"] = {low[0], low[1], low[2]};
  json["accessors"][accessor]["max"] = {high[0], high[1], high[2]};
  return accessor;
}

Json primitive_of(Json& json, Buffer& buffer, const formats::SceneMesh& mesh) {
  Json attributes;
  attributes["POSITION"] = add_positions(json, buffer, mesh.positions);
  std::vector<float> normals;
  for (const Vec3& n : vertex_normals({mesh.positions, mesh.triangles})) {
    const Vec3 unit = n.squaredNorm() > 0 ? n : Vec3(Vec3::UnitZ());
    for (int k = 0; k < 3; ++k)
      normals.push_back(static_cast<float>(unit[k]));
  }
  attributes["NORMAL"] =
      buffer.add(json, normals.data(), normals.size() * 4, 34962, 5126, "VEC3", mesh.positions.size());
  if (mesh.uvs.size() == mesh.positions.size()) {
    std::vector<float> uvs;
    for (const Vec2& uv : mesh.uvs)
      uvs.insert(uvs.end(), {static_cast<float>(uv[0]), static_cast<float>(uv[1])});
    attributes["TEXCOORD_0"] =
        buffer.add(json, uvs.data(), uvs.size() * 4, 34962, 5126, "VEC2", mesh.uvs.size());
  }
  std::vector<uint32_t> order;
  for (const Triangle& t : mesh.triangles)
    for (int corner : t)
      order.push_back(static_cast<uint32_t>(corner));
  const size_t indices =
      buffer.add(json, order.data(), order.size() * 4, 34963, 5125, "SCALAR", order.size());
  return {{"attributes", attributes}, {"indices", indices}, {"material", 0}};
}

const char* kind_name(formats::FileKind kind) {
  constexpr const char* names[] = {"glb", "gltf", "obj", "ply", "stl"};
  return names[static_cast<int>(kind)];
}

}  // namespace

rig::GltfSource gltf_source(const formats::Scene& scene, const Mat4& input_to_metres) {
  rig::GltfSource source;
  source.record.format = kind_name(scene.kind);
  if (scene.kind == formats::FileKind::glb || scene.kind == formats::FileKind::gltf) {
    source.json = scene.document.json;
    source.bin = scene.document.binary;
    return source;
  }
  source.record.bytes = scene.bytes;
  Json json = {{"asset", {{"version", "2.0"}, {"generator", "fascia"}}}, {"scene", 0}};
  json["scenes"] = Json::array({{{"nodes", {0}}}});
  Json root = {{"name", scene.path.stem().string()}};
  std::vector<double> matrix(input_to_metres.data(), input_to_metres.data() + 16);
  if (input_to_metres != Mat4::Identity()) root["matrix"] = matrix;
  json["nodes"].push_back(root);
  json["materials"] = Json::array(
      {{{"name", "head"}, {"pbrMetallicRoughness", {{"metallicFactor", 0.0}, {"roughnessFactor", 0.6}}}}});
  Buffer buffer;
  for (const formats::SceneMesh& mesh : scene.meshes) {
    const Json primitive = primitive_of(json, buffer, mesh);
    json["meshes"].push_back({{"name", mesh.name}, {"primitives", Json::array({primitive})}});
    json["nodes"].push_back({{"name", mesh.name}, {"mesh", json["meshes"].size() - 1}});
    json["nodes"][0]["children"].push_back(json["nodes"].size() - 1);
  }
  buffer.bytes.resize((buffer.bytes.size() + 3) / 4 * 4);
  json["buffers"] = Json::array({{{"byteLength", buffer.bytes.size()}}});
  source.json = json.dump();
  source.bin = std::move(buffer.bytes);
  return source;
}

}  // namespace fascia::rigging
