#include "rig/write/write.h"

#include <algorithm>

#include "geometry/error.h"
#include "gltf/edit/document.h"
#include "gltf/read/accessors.h"
#include "gltf/read/container.h"
#include "gltf/read/model.h"
#include "rig/model/extensions.h"
#include "rig/write/visitor.h"

namespace fascia::rig {
namespace {

Json parsed(const std::string& text) {
  return gltf::parsed(text, "head");
}

std::size_t length_of(const Json& root, const char* name) {
  return root.contains(name) && root[name].is_array() ? root[name].size() : 0;
}

tinygltf::Model model_of(const GltfSource& source) {
  return gltf::load_model(gltf::glb_bytes(source.json, source.bin), "head");
}

Fingerprint fingerprint_of(const tinygltf::Model& model, uint32_t mesh, uint32_t primitive,
                           const std::string& path) {
  if (mesh >= model.meshes.size() || primitive >= model.meshes[mesh].primitives.size())
    throw Error(path + ": mesh " + std::to_string(mesh) + " primitive " + std::to_string(primitive) +
                " is not in the file");
  const auto& attributes = model.meshes[mesh].primitives[primitive].attributes;
  const auto position = attributes.find("POSITION");
  if (position == attributes.end()) throw Error(path + ": the primitive has no POSITION");
  const gltf::AccessorView view = gltf::accessor_view(model, position->second, path);
  return {static_cast<uint32_t>(view.count), gltf::attribute_hash(model, position->second, path)};
}

/// The rig with every binding's fingerprint filled in.
Tissue fingerprinted(Tissue tissue, const tinygltf::Model& model) {
  for (std::size_t level = 0; level < tissue.bindings.size(); ++level)
    for (std::size_t b = 0; b < tissue.bindings[level].size(); ++b) {
      Binding& binding = tissue.bindings[level][b];
      const std::string path =
          tissue_extension + "/levels/" + std::to_string(level) + "/bindings/" + std::to_string(b);
      const Fingerprint print = fingerprint_of(model, binding.mesh, binding.primitive, path);
      if (binding.vertex_count != 0 && binding.vertex_count != print.vertex_count)
        throw Error(path + ": bound for " + std::to_string(binding.vertex_count) +
                    " vertices, but the mesh has " + std::to_string(print.vertex_count));
      binding.vertex_count = print.vertex_count;
      binding.position_hash = print.position_hash;
    }
  return tissue;
}

/// What the file was before the rig: enough to give it back.
Json source_object(const Json& root, const GltfSource& source, gltf::Appendix& appendix) {
  Json object = {{"accessors", length_of(root, "accessors")},
                 {"bufferViews", length_of(root, "bufferViews")},
                 {"buffers", length_of(root, "buffers")},
                 {"byteLength", source.bin.size()},
                 {"format", source.record.format.empty() ? "gltf" : source.record.format}};
  const std::string& notes = source.record.json;
  if (!notes.empty())
    object["notes"] = appendix.add_view({reinterpret_cast<const uint8_t*>(notes.data()), notes.size()});
  if (!source.record.bytes.empty()) object["file"] = appendix.add_view(source.record.bytes);
  return object;
}

Json tissue_object(const Rig& rig, const Tissue& tissue, gltf::Appendix& appendix) {
  if (tissue.bindings.size() != tissue.levels.size())
    throw Error(tissue_extension + "/levels: " + std::to_string(tissue.levels.size()) +
                " levels, but bindings for " + std::to_string(tissue.bindings.size()));
  Writer writer(appendix, tissue_extension);
  writer.json["specVersion"] = spec_version;
  writer.matrix("inputToMetres", rig.input_to_metres);
  if (tissue.mechanics)
    writer.object("mechanics", [&](Writer& inner) { mechanics_fields(inner, *tissue.mechanics); });
  const TissueLimits limits{rig.muscles.size(), rig.actuation.channels.size()};
  writer.array("levels", tissue.levels, [&](Writer& inner, const TissueLevel& level, std::size_t index) {
    tissue_level_fields(inner, level, limits);
    inner.array("bindings", tissue.bindings[index], [&](Writer& bound, const Binding& binding, std::size_t) {
      binding_fields(bound, binding, 3 * std::size_t{level.columns});
    });
  });
  return std::move(writer.json);
}

template <class Fields>
Json extension_object(const std::string& name, gltf::Appendix& appendix, const Fields& fields) {
  Writer writer(appendix, name);
  writer.json["specVersion"] = spec_version;
  fields(writer);
  return std::move(writer.json);
}

/// The channels begin at rest: `value` is what an animation drives.
void add_values(Json& actuation) {
  if (!actuation.contains("channels")) return;
  for (Json& channel : actuation["channels"])
    channel["value"] = channel["rest"];
}

void list_extensions(Json& root) {
  if (!root.contains("extensionsUsed")) root["extensionsUsed"] = Json::array();
  Json& used = root["extensionsUsed"];
  for (const std::string& name : extensions)
    if (std::find(used.begin(), used.end(), Json(name)) == used.end()) used.push_back(name);
}

/// Cuts list `name` of `root` back to `length`, dropping it when nothing is left.
void cut(Json& root, const char* name, std::size_t length) {
  if (!root.contains(name)) return;
  Json& list = root[name];
  while (list.size() > length)
    list.erase(list.size() - 1);
  if (list.empty()) root.erase(name);
}

/// Removes what only the rig in `root` used, as far as nothing else came behind it.
void cut_appendix(Json& root, const Json& source, std::vector<uint8_t>& bin) {
  for (const char* key :
       {"accessors", "bufferViews", "buffers", "byteLength", "endAccessors", "endBufferViews"})
    if (!source.contains(key) || !source[key].is_number_unsigned()) return;
  if (length_of(root, "accessors") != source["endAccessors"] ||
      length_of(root, "bufferViews") != source["endBufferViews"] || source["byteLength"] > bin.size())
    return;
  cut(root, "accessors", source["accessors"]);
  cut(root, "bufferViews", source["bufferViews"]);
  bin.resize(source["byteLength"]);
  cut(root, "buffers", source["buffers"]);
  if (root.contains("buffers")) root["buffers"][0]["byteLength"] = bin.size();
}

void forget_extensions(Json& root) {
  const auto ours = [](const Json& name) {
    return std::find(extensions.begin(), extensions.end(), name) != extensions.end();
  };
  if (root.contains("extensions")) {
    for (const std::string& name : extensions)
      root["extensions"].erase(name);
    if (root["extensions"].empty()) root.erase("extensions");
  }
  if (!root.contains("extensionsUsed")) return;
  Json& used = root["extensionsUsed"];
  used.erase(std::remove_if(used.begin(), used.end(), ours), used.end());
  if (used.empty()) root.erase("extensionsUsed");
}

/// A view's bytes as recorded in a rig's source object.
std::vector<uint8_t> recorded_bytes(const Json& root, const Json& source, const char* name,
                                    const std::vector<uint8_t>& bin) {
  if (!source.contains(name)) return {};
  const Json& view = root.at("bufferViews").at(source[name].get<std::size_t>());
  const std::size_t begin = view.value("byteOffset", std::size_t{0}), length = view.at("byteLength");
  if (begin > bin.size() || length > bin.size() - begin)
    throw Error(tissue_extension + "/source: beyond the file");
  return {bin.begin() + static_cast<std::ptrdiff_t>(begin),
          bin.begin() + static_cast<std::ptrdiff_t>(begin + length)};
}

}  // namespace

GltfSource glb_source(std::span<const uint8_t> bytes, const std::string& name) {
  GltfSource source;
  static_cast<gltf::Document&>(source) = gltf::glb_document(bytes, name);
  return source;
}

GltfSource embed(const GltfSource& source) {
  const auto resolve = [&](const std::string& uri) -> gltf::OutsideFile {
    auto bytes = source.resolve ? source.resolve(uri) : std::nullopt;
    return {std::move(bytes), "cannot be read; put it beside the glTF file"};
  };
  GltfSource result;
  result.record = source.record;
  static_cast<gltf::Document&>(result) = gltf::self_contained(source, resolve, "head");
  return result;
}

Fingerprint fingerprint(const GltfSource& source, uint32_t mesh, uint32_t primitive) {
  return fingerprint_of(model_of(embed(source)), mesh, primitive, "head");
}

std::vector<uint8_t> write(const GltfSource& source, const Rig& rig) {
  GltfSource base = original(embed(source));
  if (!source.record.format.empty()) base.record = source.record;
  Json root = parsed(base.json);
  const Tissue tissue = fingerprinted(rig.tissue, model_of(base));

  std::vector<uint8_t> bin = base.bin;
  gltf::Appendix appendix(root, bin);
  Json source_record = source_object(root, base, appendix);
  Json added = Json::object();
  added[skull_extension] =
      extension_object(skull_extension, appendix, [&](Writer& writer) { skull_fields(writer, rig.skull); });
  added[smas_extension] =
      extension_object(smas_extension, appendix, [&](Writer& writer) { smas_fields(writer, rig.smas); });
  const MuscleTable table = pack_muscles(rig.muscles);
  added[muscles_extension] = extension_object(muscles_extension, appendix, [&](Writer& writer) {
    muscle_table_fields(writer, table, rig.smas.surface.triangles.size());
  });
  added[tissue_extension] = tissue_object(rig, tissue, appendix);
  added[actuation_extension] = extension_object(
      actuation_extension, appendix, [&](Writer& writer) { actuation_fields(writer, rig.actuation); });
  add_values(added[actuation_extension]);

  source_record["endAccessors"] = length_of(root, "accessors");
  source_record["endBufferViews"] = length_of(root, "bufferViews");
  added[tissue_extension]["source"] = std::move(source_record);
  if (!root.contains("extensions")) root["extensions"] = Json::object();
  for (auto& [name, object] : added.items())
    root["extensions"][name] = std::move(object);
  list_extensions(root);
  if (!root.contains("buffers")) root["buffers"] = Json::array({Json::object()});
  root["buffers"][0]["byteLength"] = bin.size();

  std::vector<uint8_t> bytes = gltf::glb_bytes(gltf::text_of(root), bin);
  // A rig that our own reader refuses must not be written.
  read(bytes, "rig");
  return bytes;
}

GltfSource original(const GltfSource& rig_file) {
  Json root = parsed(rig_file.json);
  GltfSource result;
  result.resolve = rig_file.resolve;
  result.record = rig_file.record;
  result.bin = rig_file.bin;
  if (!root.contains("extensions") || !root["extensions"].is_object()) {
    result.json = rig_file.json;
    return result;
  }
  try {
    if (root["extensions"].contains(tissue_extension)) {
      const Json source = root["extensions"][tissue_extension].value("source", Json::object());
      const auto notes = recorded_bytes(root, source, "notes", result.bin);
      result.record.format = source.value("format", std::string());
      result.record.json.assign(notes.begin(), notes.end());
      result.record.bytes = recorded_bytes(root, source, "file", result.bin);
      cut_appendix(root, source, result.bin);
    }
  } catch (const nlohmann::json::exception& exception) {
    throw Error(tissue_extension + "/source: malformed: " + exception.what());
  }
  forget_extensions(root);
  result.json = gltf::text_of(root);
  return result;
}

}  // namespace fascia::rig
