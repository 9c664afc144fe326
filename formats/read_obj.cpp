#include <tiny_obj_loader.h>

#include <charconv>
#include <cmath>
#include <map>

#include "formats/detail.h"
#include "formats/obj_lines.h"
#include "gltf/read/text.h"

namespace fascia::formats::detail {

namespace {

/// The numbers of the `v` lines, three each. tinyobjloader reads what is no number as 0, so they are read
/// here.
std::vector<double> coordinates(const Scene& scene, std::string_view text) {
  std::vector<double> all;
  for (const ObjVertex& vertex : obj_vertices(text))
    for (const auto& [begin, end] : vertex.coordinates) {
      double value = 0.0;
      const size_t sign = begin < end && text[begin] == '+' ? 1 : 0;
      const auto parsed = std::from_chars(text.data() + begin + sign, text.data() + end, value);
      if (begin == end || parsed.ec != std::errc() || parsed.ptr != text.data() + end ||
          !std::isfinite(value))
        fail(scene, "line " + std::to_string(vertex.line) + ": '" +
                        gltf::as_utf8(text.substr(begin, std::min<size_t>(end - begin, 40))) +
                        "' stands where a coordinate should, a finite number");
      all.push_back(value);
    }
  return all;
}

/// Numbers of vertices that an int does not hold: tinyobjloader cuts them short and takes another vertex.
void refuse_long_indices(const Scene& scene, std::string_view plain) {
  constexpr size_t most_digits = 9;
  for (size_t at = 0; at < plain.size();) {
    const size_t end = std::min(plain.find('\n', at), plain.size());
    const std::string_view line = plain.substr(at, end - at);
    at = end + 1;
    const size_t keyword = line.find_first_not_of(" \t");
    if (keyword == line.npos || line.size() < keyword + 2 || line[keyword] != 'f' ||
        (line[keyword + 1] != ' ' && line[keyword + 1] != '\t'))
      continue;
    for (size_t i = keyword + 1; i < line.size();) {
      const size_t first = line.find_first_of("0123456789", i);
      if (first == line.npos) break;
      i = std::min(line.find_first_not_of("0123456789", first), line.size());
      const size_t digits = std::min(line.find_first_not_of('0', first), i);
      if (i - digits > most_digits)
        fail(scene, "a face names vertex " +
                        std::string(line.substr(digits, std::min<size_t>(i - digits, 40))) +
                        ", which no file has; export it again");
    }
  }
}

/// Vertices of one object, taken in the order in which its faces first name them.
struct ObjectVertices {
  std::map<std::pair<int, int>, int> index;  // (position, texture coordinate) -> vertex
};

int vertex_of(const tinyobj::attrib_t& attributes, const tinyobj::index_t& corner, SceneMesh& mesh,
              ObjectVertices& vertices) {
  const auto [entry, is_new] = vertices.index.try_emplace({corner.vertex_index, corner.texcoord_index},
                                                          static_cast<int>(mesh.positions.size()));
  if (is_new) {
    const double* p = &attributes.vertices[3 * static_cast<size_t>(corner.vertex_index)];
    mesh.positions.emplace_back(p[0], p[1], p[2]);
    mesh.source_vertices.push_back(corner.vertex_index);
    mesh.source_textures.push_back(corner.texcoord_index);
    if (!attributes.texcoords.empty()) {
      Vec2 uv(0, 0);
      const size_t t = 2 * static_cast<size_t>(std::max(0, corner.texcoord_index));
      if (corner.texcoord_index >= 0 && t + 1 < attributes.texcoords.size())
        uv = Vec2(attributes.texcoords[t], 1.0 - attributes.texcoords[t + 1]);
      mesh.uvs.push_back(uv);
    }
  }
  return entry->second;
}

void read_object(const Scene& scene, const tinyobj::attrib_t& attributes, const tinyobj::shape_t& shape,
                 const std::vector<tinyobj::material_t>& materials, SceneMesh& mesh) {
  ObjectVertices vertices;
  size_t corner = 0;
  const int count = static_cast<int>(attributes.vertices.size() / 3);
  for (unsigned face_size : shape.mesh.num_face_vertices) {
    std::vector<int> polygon;
    for (unsigned k = 0; k < face_size; ++k, ++corner) {
      const tinyobj::index_t& at = shape.mesh.indices[corner];
      if (at.vertex_index < 0 || at.vertex_index >= count)
        fail(scene, "object '" + gltf::as_utf8(shape.name) + "' has a face that names vertex " +
                        std::to_string(at.vertex_index + 1) + " of " + std::to_string(count));
      polygon.push_back(vertex_of(attributes, at, mesh, vertices));
    }
    triangulate(mesh.positions, polygon, mesh.triangles);
    mesh.polygons.push_back(std::move(polygon));
  }
  if (!shape.mesh.material_ids.empty() && shape.mesh.material_ids[0] >= 0 &&
      shape.mesh.material_ids[0] < static_cast<int>(materials.size()))
    mesh.material = gltf::as_utf8(materials[shape.mesh.material_ids[0]].name);
}

}  // namespace

void read_obj(Scene& scene) {
  tinyobj::ObjReaderConfig config;
  config.triangulate = false;
  config.vertex_color = false;
  tinyobj::ObjReader reader;
  const std::string_view text(reinterpret_cast<const char*>(scene.bytes.data()), scene.bytes.size());
  const std::vector<double> places = coordinates(scene, text);
  // Materials are the file's own business; only the geometry is read.
  const std::string plain = plain_obj(text);
  refuse_long_indices(scene, plain);
  if (!reader.ParseFromString(plain, "", config))
    fail(scene, "it is not a readable OBJ file: " + gltf::as_utf8(reader.Error()));
  tinyobj::attrib_t attributes = reader.GetAttrib();
  if (attributes.vertices.size() != places.size()) fail(scene, "its 'v' lines are damaged");
  attributes.vertices = places;
  if (attributes.vertices.empty()) fail(scene, "it holds no vertices (no 'v' lines)");
  for (const tinyobj::shape_t& shape : reader.GetShapes()) {
    if (shape.mesh.indices.empty()) continue;
    SceneMesh mesh;
    mesh.name =
        shape.name.empty() ? "object_" + std::to_string(scene.meshes.size()) : gltf::as_utf8(shape.name);
    read_object(scene, attributes, shape, reader.GetMaterials(), mesh);
    scene.meshes.push_back(std::move(mesh));
  }
}

}  // namespace fascia::formats::detail
