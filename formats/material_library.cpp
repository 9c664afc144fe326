#include "formats/material_library.h"

#include <tiny_obj_loader.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

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
  PictureReader(Scene& scene, const ReadOptions& options) : scene_(scene), options_(options) {}

  std::shared_ptr<const std::vector<uint8_t>> read(const std::string& name) {
    if (name.empty()) return nullptr;
    const auto [entry, is_new] = known_.try_emplace(name);
    if (!is_new) return entry->second;
    FileBeside file = read_beside(scene_.path, name, options_.allow_outside);
    if (!file.bytes) {
      scene_.warnings.push_back("texture '" + gltf::as_utf8(name) + "' is left out: " + file.why);
      return nullptr;
    }
    const std::string kind = gltf::picture_type(*file.bytes);
    if (kind != "image/png" && kind != "image/jpeg") {
      scene_.warnings.push_back("texture '" + gltf::as_utf8(name) +
                                "' is left out: glTF holds PNG and JPEG only; convert it to one of them");
      return nullptr;
    }
    return entry->second = std::make_shared<const std::vector<uint8_t>>(std::move(*file.bytes));
  }

 private:
  Scene& scene_;
  const ReadOptions& options_;
  std::map<std::string, std::shared_ptr<const std::vector<uint8_t>>> known_;
};

double bounded(double value, double otherwise) {
  return std::isfinite(value) ? std::clamp(value, 0.0, 1.0) : otherwise;
}

}  // namespace

std::string material_text(Scene& scene, std::string_view obj, const ReadOptions& options) {
  std::string all;
  for (size_t at = 0; at < obj.size();) {
    size_t end = std::min(obj.find('\n', at), obj.size());
    const std::string_view line = obj.substr(at, end - at);
    at = end + 1;
    if (line.substr(0, 7) != "mtllib " && line.substr(0, 7) != "mtllib\t") continue;
    const std::string name = argument_of(line);
    FileBeside file = read_beside(scene.path, name, options.allow_outside);
    if (file.bytes)
      all.append(file.bytes->begin(), file.bytes->end()).append("\n");
    else
      scene.warnings.push_back("materials '" + gltf::as_utf8(name) + "' are left out: " + file.why);
  }
  return all;
}

std::vector<SceneMaterial> read_materials(Scene& scene, const std::string& text, const ReadOptions& options) {
  std::map<std::string, int> by_name;
  std::vector<tinyobj::material_t> found;
  std::string warning, error;
  std::istringstream stream(text);
  tinyobj::LoadMtl(&by_name, &found, &stream, &warning, &error);
  PictureReader pictures(scene, options);
  std::vector<SceneMaterial> materials;
  for (const tinyobj::material_t& from : found) {
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
    material.has_alpha = !from.alpha_texname.empty() || material.opacity < 1.0;
    materials.push_back(std::move(material));
  }
  return materials;
}

}  // namespace fascia::formats
