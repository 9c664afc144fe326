#include "cli/gltf_edit.h"

#include <algorithm>
#include <set>

#include "formats/gltf_document.h"
#include "geometry/error.h"

namespace fascia::cli {

namespace {

using Json = nlohmann::ordered_json;
using rig::Vec3f;

const char* type_name(int width) {
  switch (width) {
    case 1:
      return "SCALAR";
    case 2:
      return "VEC2";
    case 3:
      return "VEC3";
    default:
      return "VEC4";
  }
}

}  // namespace

GltfEdit::GltfEdit(rig::GltfSource source) : json(Json::parse(source.json)), binary_(std::move(source.bin)) {}

size_t GltfEdit::add_view(const void* data, size_t size, int target) {
  binary_.resize((binary_.size() + 3) / 4 * 4);
  Json view = {{"buffer", 0}, {"byteOffset", binary_.size()}, {"byteLength", size}};
  if (target) view["target"] = target;
  json["bufferViews"].push_back(view);
  const auto* raw = static_cast<const uint8_t*>(data);
  binary_.insert(binary_.end(), raw, raw + size);
  return json["bufferViews"].size() - 1;
}

size_t GltfEdit::add_floats(std::span<const float> values, int width, bool bounds, int target) {
  const size_t count = values.size() / static_cast<size_t>(width);
  Json accessor = {{"bufferView", add_view(values.data(), values.size_bytes(), target)},
                   {"componentType", 5126},
                   {"count", count},
                   {"type", type_name(width)}};
  if (bounds && count > 0) {
    std::vector<float> low(values.begin(), values.begin() + width), high = low;
    for (size_t i = 0; i < values.size(); ++i) {
      float& least = low[i % static_cast<size_t>(width)];
      float& most = high[i % static_cast<size_t>(width)];
      least = std::min(least, values[i]);
      most = std::max(most, values[i]);
    }
    accessor["min"] = low;
    accessor["max"] = high;
  }
  json["accessors"].push_back(accessor);
  return json["accessors"].size() - 1;
}

size_t GltfEdit::add_sparse(size_t count, std::span<const uint32_t> indices, std::span<const Vec3f> values) {
  const bool is_dense = count > 0 && indices.size() == count;
  Vec3f low = is_dense ? values[0] : Vec3f(Vec3f::Zero()), high = low;
  for (const Vec3f& v : values) {
    low = low.cwiseMin(v);
    high = high.cwiseMax(v);
  }
  Json accessor = {{"componentType", 5126},
                   {"count", count},
                   {"type", "VEC3"},
                   {"min", {low[0], low[1], low[2]}},
                   {"max", {high[0], high[1], high[2]}}};
  if (!indices.empty()) {
    const size_t index_view = add_view(indices.data(), indices.size_bytes(), 0);
    const size_t value_view = add_view(values.data(), values.size_bytes(), 0);
    accessor["sparse"] = {{"count", indices.size()},
                          {"indices", {{"bufferView", index_view}, {"componentType", 5125}}},
                          {"values", {{"bufferView", value_view}}}};
  }
  json["accessors"].push_back(accessor);
  return json["accessors"].size() - 1;
}

Json& GltfEdit::primitive(uint32_t mesh, uint32_t index) {
  return json["meshes"].at(mesh)["primitives"].at(index);
}

std::vector<uint8_t> GltfEdit::bytes() const {
  Json out = json;
  std::vector<uint8_t> binary = binary_;
  binary.resize((binary.size() + 3) / 4 * 4);
  if (!binary.empty()) {
    if (!out.contains("buffers")) out["buffers"] = Json::array({Json::object()});
    out["buffers"][0]["byteLength"] = binary.size();
  }
  return formats::glb_bytes({out.dump(), binary});
}

void set_pose(GltfEdit& edit, const PosedPrimitive& posed) {
  const size_t position = edit.add_floats(posed.positions, 3, true, 34962);
  const bool has_normals = edit.primitive(posed.mesh, posed.primitive)["attributes"].contains("NORMAL");
  const size_t normal = has_normals ? edit.add_floats(posed.normals, 3, false, 34962) : 0;
  Json& attributes = edit.primitive(posed.mesh, posed.primitive)["attributes"];
  attributes["POSITION"] = position;
  if (has_normals) attributes["NORMAL"] = normal;
}

void add_morph_targets(GltfEdit& edit, const std::vector<std::string>& names,
                       const std::vector<std::vector<PrimitiveMotion>>& shapes) {
  std::set<uint32_t> meshes;
  for (const auto& shape : shapes)
    for (const PrimitiveMotion& motion : shape)
      meshes.insert(motion.mesh);
  for (uint32_t mesh : meshes) {
    const size_t primitives = edit.json["meshes"].at(mesh)["primitives"].size();
    size_t had = 0;
    for (size_t p = 0; p < primitives; ++p) {
      Json& primitive = edit.primitive(mesh, static_cast<uint32_t>(p));
      if (primitive.contains("targets"))
        had = std::max(had, primitive["targets"].size());
      else
        primitive["targets"] = Json::array();
    }
    for (size_t s = 0; s < shapes.size(); ++s)
      for (size_t p = 0; p < primitives; ++p) {
        const size_t position =
            edit.primitive(mesh, static_cast<uint32_t>(p))["attributes"]["POSITION"].get<size_t>();
        const size_t count = edit.json["accessors"].at(position)["count"].get<size_t>();
        std::vector<uint32_t> indices;
        std::vector<Vec3f> values;
        for (const PrimitiveMotion& motion : shapes[s]) {
          if (motion.mesh != mesh || motion.primitive != p) continue;
          for (size_t v = 0; v < motion.displacement.size(); ++v)
            if (!motion.displacement[v].isZero(0)) {
              indices.push_back(static_cast<uint32_t>(v));
              values.push_back(motion.displacement[v]);
            }
        }
        const size_t accessor = edit.add_sparse(count, indices, values);
        edit.primitive(mesh, static_cast<uint32_t>(p))["targets"].push_back({{"POSITION", accessor}});
      }
    Json& entry = edit.json["meshes"][mesh];
    Json old_names =
        entry.contains("extras") && entry["extras"].is_object() && entry["extras"].contains("targetNames")
            ? entry["extras"]["targetNames"]
            : Json::array();
    while (old_names.size() < had)
      old_names.push_back("target_" + std::to_string(old_names.size()));
    for (const std::string& name : names)
      old_names.push_back(name);
    if (!entry.contains("extras") || !entry["extras"].is_object()) entry["extras"] = Json::object();
    entry["extras"]["targetNames"] = old_names;
    Json weights = entry.contains("weights") ? entry["weights"] : Json::array();
    while (weights.size() < had + names.size())
      weights.push_back(0.0);
    entry["weights"] = weights;
  }
}

}  // namespace fascia::cli
