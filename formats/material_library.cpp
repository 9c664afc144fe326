#include "formats/material_library.h"

#include <tiny_obj_loader.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <set>
#include <sstream>
#include <string_view>

#include "formats/files.h"
#include "gltf/edit/uri.h"
#include "gltf/read/text.h"

namespace fascia::formats {

namespace {

/// The rest of a line behind its first word, without blanks at either end.
std::string argument_of(std::string_view line) {
  const auto is_blank = [](char c) { return c == ' ' || c == '\t' || c == '\r'; };
  size_t begin = 0, end = line.size();
  while (begin < end && !is_blank(line[begin]))
    ++begin;
  while (begin < end && is_blank(line[begin]))
    ++begin;
  while (end > begin && is_blank(line[end - 1]))
    --end;
  return std::string(line.substr(begin, end - begin));
}

class PictureReader {
 public:
  PictureReader(const Scene& scene, std::vector<std::string>& warnings)
      : scene_(scene), warnings_(warnings) {}

  std::shared_ptr<const std::vector<uint8_t>> read(const std::string& name) {
    if (name.empty()) return nullptr;
    const auto [entry, is_new] = known_.try_emplace(name);
    if (!is_new) return entry->second;
    FileBeside file = read_beside(scene_.path, name, scene_.options.outside);
    if (!file.bytes) {
      warnings_.push_back("texture '" + gltf::as_utf8(name) + "' is left out: " + file.why);
      return nullptr;
    }
    const std::string kind = gltf::picture_type(*file.bytes);
    if (kind != "image/png" && kind != "image/jpeg") {
      warnings_.push_back("texture '" + gltf::as_utf8(name) +
                          "' is left out: glTF holds PNG and JPEG only; convert it to one of them");
      return nullptr;
    }
    return entry->second = std::make_shared<const std::vector<uint8_t>>(std::move(*file.bytes));
  }

 private:
  const Scene& scene_;
  std::vector<std::string>& warnings_;
  std::map<std::string, std::shared_ptr<const std::vector<uint8_t>>> known_;
};

double bounded(double value, double otherwise) {
  return std::isfinite(value) ? std::clamp(value, 0.0, 1.0) : otherwise;
}

/// What an OBJ's lines say of materials.
struct ObjMaterials {
  std::vector<std::string> libraries;
  std::vector<std::string> of_mesh;  ///< material of the mesh's face that is looked for; empty if it has none
  std::map<std::string, std::set<std::string>> of_object;  ///< of all faces of an object or group
};

/// `v` lines of a face that the file itself has (vertices appended to it come last), ascending.
std::vector<int> face_of(const SceneMesh& mesh) {
  std::vector<int> lines;
  for (const std::vector<int>& polygon : mesh.polygons) {
    std::vector<int> here;
    for (const int v : polygon)
      here.push_back(mesh.source_vertices[static_cast<size_t>(v)]);
    std::sort(here.begin(), here.end());
    if (lines.empty() || here.back() < lines.back()) lines = std::move(here);
  }
  return lines;
}

ObjMaterials scan(std::string_view obj, const std::vector<SceneMesh>& meshes) {
  ObjMaterials found;
  found.of_mesh.resize(meshes.size());
  std::map<std::vector<int>, size_t> wanted;
  for (size_t m = 0; m < meshes.size(); ++m)
    wanted.try_emplace(face_of(meshes[m]), m);
  std::string current, object;
  int vertices = 0;
  for (size_t at = 0; at < obj.size();) {
    const size_t end = std::min(obj.find('\n', at), obj.size());
    const std::string_view line = obj.substr(at, end - at);
    at = end + 1;
    const auto begins = [&](std::string_view word) {
      return line.size() > word.size() && line.substr(0, word.size()) == word &&
             (line[word.size()] == ' ' || line[word.size()] == '\t');
    };
    if (begins("mtllib")) found.libraries.push_back(argument_of(line));
    if (begins("usemtl")) current = argument_of(line);
    if (begins("o") || begins("g")) object = argument_of(line);
    if (begins("v")) ++vertices;
    if (!begins("f") || current.empty()) continue;
    found.of_object[object].insert(current);
    if (wanted.empty()) continue;
    std::istringstream words{std::string(line.substr(1))};
    std::vector<int> face;
    for (std::string word; words >> word;) {
      const int index = std::atoi(word.c_str());
      face.push_back(index < 0 ? vertices + index : index - 1);
    }
    std::sort(face.begin(), face.end());
    if (const auto mesh = wanted.find(face); mesh != wanted.end()) {
      found.of_mesh[mesh->second] = current;
      wanted.erase(mesh);
    }
  }
  return found;
}

SceneMaterial material_of(const tinyobj::material_t& from, PictureReader& pictures) {
  SceneMaterial material;
  material.name = gltf::as_utf8(from.name);
  for (int k = 0; k < 3; ++k)
    material.colour[k] = bounded(from.diffuse[k], 0.8);
  material.opacity = bounded(from.dissolve, 1.0);
  // Phong's exponent as the roughness of the lobe of the same width: Karis 2013, specular BRDF reference.
  if (from.roughness > 0)
    material.roughness = bounded(from.roughness, 0.6);
  else if (from.shininess > 1)
    material.roughness = bounded(std::pow(2.0 / (from.shininess + 2.0), 0.25), 0.6);
  material.colour_map = pictures.read(from.diffuse_texname);
  material.normal_map = pictures.read(from.normal_texname);
  material.roughness_map = pictures.read(from.roughness_texname);
  material.has_alpha = !from.alpha_texname.empty() || material.opacity < 1.0;
  return material;
}

}  // namespace

MaterialLibrary read_materials(const Scene& scene) {
  MaterialLibrary library;
  library.of_mesh.assign(scene.meshes.size(), -1);
  if (scene.kind != FileKind::obj) return library;
  const ObjMaterials found = scan(
      std::string_view(reinterpret_cast<const char*>(scene.bytes.data()), scene.bytes.size()), scene.meshes);
  std::map<std::string, int> by_name;
  PictureReader pictures(scene, library.warnings);
  for (const std::string& name : found.libraries) {
    const FileBeside file = read_beside(scene.path, name, scene.options.outside);
    if (!file.bytes) {
      // Many a head comes without; one that is there and not opened is another matter.
      if (file.why.starts_with("lies outside"))
        library.warnings.push_back("material library '" + gltf::as_utf8(name) + "' is left out: " + file.why);
      continue;
    }
    std::istringstream text(std::string(file.bytes->begin(), file.bytes->end()));
    std::map<std::string, int> ignored;
    std::vector<tinyobj::material_t> read;
    std::string warning, error;
    tinyobj::LoadMtl(&ignored, &read, &text, &warning, &error);
    for (const tinyobj::material_t& one : read) {
      by_name.try_emplace(one.name, static_cast<int>(library.materials.size()));
      library.materials.push_back(material_of(one, pictures));
    }
  }
  for (const auto& [object, names] : found.of_object)
    if (names.size() > 1 && !by_name.empty())
      library.warnings.push_back(
          "object '" + gltf::as_utf8(object) + "' has " + std::to_string(names.size()) +
          " materials, and the rig shows the first: for all, make each an object or export GLB");
  for (size_t m = 0; m < scene.meshes.size(); ++m) {
    const auto material = by_name.find(found.of_mesh[m]);
    if (material != by_name.end()) library.of_mesh[m] = material->second;
  }
  return library;
}

}  // namespace fascia::formats
