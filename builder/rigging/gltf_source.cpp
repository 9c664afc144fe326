#include "builder/rigging/gltf_source.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <unordered_map>

#include "formats/material_library.h"
#include "geometry/json.h"
#include "gltf/edit/appendix.h"
#include "gltf/edit/uri.h"

namespace fascia::rigging {

namespace {

template <class Point, int n>
size_t add(gltf::Appendix& data, const std::vector<Point>& points, bool bounds) {
  std::vector<float> values;
  values.reserve(n * points.size());
  for (const Point& p : points)
    for (int k = 0; k < n; ++k)
      values.push_back(static_cast<float>(p[k]));
  return data.add_floats(values, n, bounds, gltf::vertex_target);
}

/// Tangents for a normal map, xyz and handedness a vertex: where the first texture coordinate grows, square
/// to the unit `normals`, averaged over the triangles about a vertex (Lengyel 2001, Computing tangent space
/// basis vectors for an arbitrary mesh). The second grows downward in glTF, its bitangent points upward.
std::vector<Eigen::Vector4d> texture_tangents(const formats::SceneMesh& mesh,
                                              const std::vector<Vec3>& normals) {
  std::vector<Vec3> along(mesh.positions.size(), Vec3::Zero()), upward = along;
  for (const Triangle& t : mesh.triangles) {
    const auto corner = [&](int k) { return static_cast<size_t>(t[static_cast<size_t>(k)]); };
    Eigen::Matrix<double, 3, 2> edges;
    Eigen::Matrix2d texture;
    for (int k = 0; k < 2; ++k) {
      edges.col(k) = mesh.positions[corner(k + 1)] - mesh.positions[corner(0)];
      texture.col(k) = mesh.uvs[corner(k + 1)] - mesh.uvs[corner(0)];
    }
    if (!(std::abs(texture.determinant()) > 1e-20)) continue;
    const Eigen::Matrix<double, 3, 2> slopes = edges * texture.inverse();
    const double area = edges.col(0).cross(edges.col(1)).norm();
    for (int k = 0; k < 3; ++k) {
      along[corner(k)] += area * slopes.col(0).stableNormalized();
      upward[corner(k)] -= area * slopes.col(1).stableNormalized();
    }
  }
  std::vector<Eigen::Vector4d> tangents(along.size());
  for (size_t v = 0; v < along.size(); ++v) {
    const Vec3 square = along[v] - normals[v].dot(along[v]) * normals[v];
    const Vec3 tangent =
        square.norm() > 1e-12 * along[v].norm() ? Vec3(square.normalized()) : normals[v].unitOrthogonal();
    tangents[v] << tangent, normals[v].cross(tangent).dot(upward[v]) < 0.0 ? -1.0 : 1.0;
  }
  return tangents;
}

/// Unit normals of each mesh's vertices, smooth where the surface is one: copies of a `v` line, at seams of
/// textures, of groups or of materials, have the normal of all triangles about it.
std::vector<std::vector<Vec3>> smooth_normals(const formats::Scene& scene) {
  std::unordered_map<int, Vec3> by_line;
  std::vector<std::vector<Vec3>> normals;
  for (const formats::SceneMesh& mesh : scene.meshes) {
    normals.push_back(vertex_area_vectors(mesh.positions, mesh.triangles));
    for (size_t v = 0; v < mesh.source_vertices.size(); ++v)
      by_line.try_emplace(mesh.source_vertices[v], Vec3::Zero()).first->second += normals.back()[v];
  }
  for (size_t m = 0; m < normals.size(); ++m)
    for (size_t v = 0; v < normals[m].size(); ++v) {
      Vec3& normal = normals[m][v];
      const std::vector<int>& lines = scene.meshes[m].source_vertices;
      if (v < lines.size()) normal = by_line.at(lines[v]);
      normal = normal.stableNormalized();
      if (!(normal.squaredNorm() > 0.5)) normal = Vec3::UnitZ();
    }
  return normals;
}

gltf::Json primitive_of(gltf::Appendix& data, const formats::SceneMesh& mesh,
                        const std::vector<Vec3>& normals, int material, bool has_normal_map) {
  gltf::Json attributes;
  attributes["POSITION"] = add<Vec3, 3>(data, mesh.positions, true);
  attributes["NORMAL"] = add<Vec3, 3>(data, normals, false);
  if (has_normal_map && mesh.uvs.size() == mesh.positions.size())
    attributes["TANGENT"] = add<Eigen::Vector4d, 4>(data, texture_tangents(mesh, normals), false);
  if (mesh.uvs.size() == mesh.positions.size())
    attributes["TEXCOORD_0"] = add<Vec2, 2>(data, mesh.uvs, false);
  if (mesh.colours.size() == mesh.positions.size())
    attributes["COLOR_0"] = add<Vec3, 3>(data, mesh.colours, false);
  std::vector<uint32_t> corners;
  for (const Triangle& t : mesh.triangles)
    corners.insert(corners.end(), t.begin(), t.end());
  // Material 0 is for what the file gives none.
  return {{"attributes", attributes}, {"indices", data.add_indices(corners)}, {"material", material + 1}};
}

/// Appends a picture's file as an image and a texture; returns the texture's place, -1 without a picture.
int add_texture(gltf::Json& json, gltf::Appendix& data,
                const std::shared_ptr<const std::vector<uint8_t>>& picture) {
  if (!picture) return -1;
  const gltf::Json image = {{"bufferView", data.add_view(*picture)},
                            {"mimeType", gltf::picture_type(*picture)}};
  int at = 0;
  for (const gltf::Json& known : json.value("images", gltf::Json::array())) {
    if (known == image) return at;  // its bytes are stored once
    ++at;
  }
  json["images"].push_back(image);
  json["textures"].push_back({{"source", at}});
  return at;
}

void add_materials(gltf::Json& json, gltf::Appendix& data, const formats::MaterialLibrary& library) {
  // glTF's factors are linear, OBJ's as seen (sRGB).
  const auto linear = [](double value) { return std::pow(value, 2.2); };
  for (const formats::SceneMaterial& from : library.materials) {
    gltf::Json metal = {{"metallicFactor", 0.0}, {"roughnessFactor", from.roughness}};
    gltf::Json material = {{"name", from.name}};
    if (const int map = add_texture(json, data, from.colour_map); map >= 0)
      metal["baseColorTexture"] = {{"index", map}};
    else
      metal["baseColorFactor"] = {linear(from.colour[0]), linear(from.colour[1]), linear(from.colour[2]),
                                  from.opacity};
    // glTF reads roughness from green and metal from blue, which the factor above makes nothing of.
    if (const int map = add_texture(json, data, from.roughness_map); map >= 0) {
      metal["metallicRoughnessTexture"] = {{"index", map}};
      metal["roughnessFactor"] = 1.0;
    }
    if (const int map = add_texture(json, data, from.normal_map); map >= 0)
      material["normalTexture"] = {{"index", map}};
    material["pbrMetallicRoughness"] = metal;
    if (from.has_alpha) material["alphaMode"] = from.colour_map ? "MASK" : "BLEND";
    if (from.has_alpha) material["doubleSided"] = true;
    json["materials"].push_back(material);
  }
}

const char* kind_name(formats::FileKind kind) {
  constexpr const char* names[] = {"glb", "gltf", "obj", "ply", "stl"};
  return names[static_cast<int>(kind)];
}

/// What the file itself does not tell: where its coordinates have their origin, and which `v` line each
/// vertex came from where the vertices of an OBJ do not come in the order of its faces (its lips or lids have
/// been parted).
std::string notes_of(const formats::Scene& scene) {
  gltf::Json notes;
  if (!scene.offset.isZero(0)) notes["offset"] = {scene.offset[0], scene.offset[1], scene.offset[2]};
  if (scene.kind == formats::FileKind::obj && scene.is_extended) {
    notes["sourceVertices"] = gltf::Json::array();
    for (const formats::SceneMesh& mesh : scene.meshes)
      notes["sourceVertices"].push_back(mesh.source_vertices);
  }
  return notes.is_null() ? std::string() : notes.dump();
}

}  // namespace

rig::GltfSource gltf_source(const formats::Scene& scene, const Mat4& input_to_metres,
                            std::vector<std::string>* warnings) {
  rig::GltfSource source;
  source.record.format = kind_name(scene.kind);
  source.record.json = notes_of(scene);
  if (scene.kind == formats::FileKind::glb || scene.kind == formats::FileKind::gltf) {
    source.json = scene.document.json;
    source.bin = scene.document.bin;
    return source;
  }
  source.record.bytes = scene.bytes;
  gltf::Json json = {{"asset", {{"version", "2.0"}, {"generator", "fascia"}}}, {"scene", 0}};
  json["scenes"] = gltf::Json::array({{{"nodes", {0}}}});
  gltf::Json root = {{"name", scene.path.stem().string()}};
  // Turned and scaled to glTF's axes and metres; a character stays on its origin, wherever the rig has its
  // own.
  Mat4 to_metres = input_to_metres;
  to_metres.topRightCorner<3, 1>().setZero();
  const std::vector<double> matrix(to_metres.data(), to_metres.data() + 16);
  if (to_metres != Mat4::Identity()) root["matrix"] = matrix;
  json["nodes"].push_back(root);
  json["materials"] = gltf::Json::array(
      {{{"name", "head"}, {"pbrMetallicRoughness", {{"metallicFactor", 0.0}, {"roughnessFactor", 0.6}}}}});
  gltf::Appendix data(json, source.bin);
  const formats::MaterialLibrary library = formats::read_materials(scene);
  if (warnings) warnings->insert(warnings->end(), library.warnings.begin(), library.warnings.end());
  add_materials(json, data, library);
  const std::vector<std::vector<Vec3>> normals = smooth_normals(scene);
  for (size_t m = 0; m < scene.meshes.size(); ++m) {
    const formats::SceneMesh& mesh = scene.meshes[m];
    const int look = m < library.of_mesh.size() ? library.of_mesh[m] : -1;
    const bool has_normal_map = look >= 0 && library.materials[static_cast<size_t>(look)].normal_map;
    const gltf::Json primitive = primitive_of(data, mesh, normals[m], look, has_normal_map);
    json["meshes"].push_back({{"name", mesh.name}, {"primitives", gltf::Json::array({primitive})}});
    json["nodes"].push_back({{"name", mesh.name}, {"mesh", json["meshes"].size() - 1}});
    json["nodes"][0]["children"].push_back(json["nodes"].size() - 1);
  }
  json["buffers"] = gltf::Json::array({{{"byteLength", source.bin.size()}}});
  source.json = gltf::text_of(json);
  return source;
}

Vec3 input_offset(const rig::SourceRecord& record) {
  const gltf::Json notes =
      parse_json<gltf::Json>(record.json.empty() ? "{}" : record.json, "the rig's notes");
  const gltf::Json offset = notes.is_object() ? notes.value("offset", gltf::Json()) : gltf::Json();
  if (!offset.is_array() || offset.size() != 3) return Vec3::Zero();
  Vec3 place = Vec3::Zero();
  for (size_t k = 0; k < 3; ++k)
    if (offset[k].is_number()) place[static_cast<Eigen::Index>(k)] = offset[k].get<double>();
  return place;
}

}  // namespace fascia::rigging
