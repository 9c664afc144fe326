// TINYOBJLOADER_USE_DOUBLE is set for this room: its library is built with it.
#include <tiny_obj_loader.h>
#include <cmath>

#include <sstream>
#include <unordered_map>

#include "anatomy/fields.h"

namespace fascia::anatomy {
namespace {

/// One object with only its own vertices, polygons as fans.
MeshObject object_of(const tinyobj::attrib_t& attributes, const tinyobj::shape_t& shape,
                     const std::string& file) {
  MeshObject object;
  object.name = shape.name;
  std::unordered_map<int, int> own;
  const auto vertex = [&](const tinyobj::index_t& corner) {
    const auto [place, added] =
        own.emplace(corner.vertex_index, static_cast<int>(object.mesh.vertices.size()));
    if (added) {
      const size_t i = 3 * static_cast<size_t>(corner.vertex_index);
      object.mesh.vertices.emplace_back(attributes.vertices[i] * 1e-3, attributes.vertices[i + 1] * 1e-3,
                                        attributes.vertices[i + 2] * 1e-3);
    }
    return place->second;
  };
  const auto uv = [&](const tinyobj::index_t& corner) {
    const size_t i = 2 * static_cast<size_t>(corner.texcoord_index);
    return Vec2(attributes.texcoords[i], attributes.texcoords[i + 1]);
  };
  bool has_uvs = true;
  for (const tinyobj::index_t& corner : shape.mesh.indices)
    has_uvs = has_uvs && corner.texcoord_index >= 0;
  size_t begin = 0;
  for (const auto corners : shape.mesh.num_face_vertices) {
    for (size_t k = 1; k + 1 < corners; ++k) {
      const tinyobj::index_t* at = &shape.mesh.indices[begin];
      object.mesh.triangles.push_back({vertex(at[0]), vertex(at[k]), vertex(at[k + 1])});
      if (has_uvs) object.corner_uvs.push_back({uv(at[0]), uv(at[k]), uv(at[k + 1])});
    }
    begin += corners;
  }
  if (object.mesh.empty()) throw Error(file + ", " + object.name + ": has no faces");
  return object;
}

/// `text` without its group lines when it names objects: the parser would cut an object into its groups.
std::string objects_only(const std::string& text) {
  if (text.rfind("o ", 0) != 0 && text.find("\no ") == std::string::npos) return text;
  std::istringstream lines(text);
  std::string result;
  result.reserve(text.size());
  for (std::string line; std::getline(lines, line);)
    if (line != "g" && line.rfind("g ", 0) != 0) result += line + "\n";
  return result;
}

}  // namespace

std::vector<MeshObject> load_objects(const DataFiles& files, const std::string& name) {
  tinyobj::attrib_t attributes;
  std::vector<tinyobj::shape_t> shapes;
  std::vector<tinyobj::material_t> materials;
  std::string warnings, errors;
  std::istringstream stream(objects_only(files.read(name)));
  const bool parsed =
      tinyobj::LoadObj(&attributes, &shapes, &materials, &warnings, &errors, &stream, nullptr, false);
  if (!parsed || !errors.empty()) throw Error(files.place(name) + ": is not a sound OBJ file: " + errors);
  std::vector<MeshObject> objects;
  for (const tinyobj::shape_t& shape : shapes)
    if (!shape.mesh.indices.empty()) objects.push_back(object_of(attributes, shape, name));
  if (objects.empty()) throw Error(files.place(name) + ": holds no faces");
  return objects;
}

void load_skin_regions(const DataFiles& files, GenericAnatomy& anatomy) {
  const Json document = files.json("head_regions.json");
  const Fields root(document, files.place("head_regions.json"));
  const Fields faces = root.object("objects").object("skin").object("faces");
  for (const std::string& name : faces.keys()) {
    const Fields range = faces.object(name.c_str());
    const double first = range.number("first"), count = range.number("count");
    if (!(first >= 0.0 && count >= 1.0 && first == std::floor(first) && count == std::floor(count)))
      range.fail("\"first\" and \"count\" must be whole numbers of polygons");
    anatomy.skin_regions.push_back({name, static_cast<size_t>(first), static_cast<size_t>(count)});
  }
}

}  // namespace fascia::anatomy
