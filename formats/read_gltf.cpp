#include <Eigen/Geometry>
#include <algorithm>
#include <array>

#include "formats/detail.h"
#include "geometry/error.h"
#include "gltf/edit/document.h"
#include "gltf/edit/instances.h"
#include "gltf/read/accessors.h"
#include "gltf/read/container.h"
#include "gltf/read/model.h"

namespace fascia::formats::detail {

namespace {

Mat4 local_matrix(const tinygltf::Node& node) {
  Mat4 matrix = Mat4::Identity();
  if (node.matrix.size() == 16) {
    for (int i = 0; i < 16; ++i)
      matrix(i % 4, i / 4) = node.matrix[static_cast<size_t>(i)];
    return matrix;
  }
  Eigen::Affine3d affine = Eigen::Affine3d::Identity();
  if (node.translation.size() == 3)
    affine.translate(Vec3(node.translation[0], node.translation[1], node.translation[2]));
  if (node.rotation.size() == 4) {
    Eigen::Quaterniond turn(node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2]);
    if (turn.norm() > 0) affine.rotate(turn.normalized());
  }
  if (node.scale.size() == 3) affine.scale(Vec3(node.scale[0], node.scale[1], node.scale[2]));
  return affine.matrix();
}

/// The nodes, each behind its parent. Fails when they form a cycle.
std::vector<size_t> parents_first(const Scene& scene, const tinygltf::Model& model,
                                  std::vector<int>& parent) {
  parent.assign(model.nodes.size(), -1);
  for (size_t n = 0; n < model.nodes.size(); ++n)
    for (int child : model.nodes[n].children) {
      if (child < 0 || child >= static_cast<int>(model.nodes.size()))
        fail(scene, "a node names a child that is not there");
      parent[static_cast<size_t>(child)] = static_cast<int>(n);
    }
  std::vector<size_t> order;
  for (size_t n = 0; n < model.nodes.size(); ++n)
    if (parent[n] < 0) order.push_back(n);
  for (size_t i = 0; i < order.size(); ++i)
    for (int child : model.nodes[order[i]].children)
      if (parent[static_cast<size_t>(child)] == static_cast<int>(order[i]))
        order.push_back(static_cast<size_t>(child));
  if (order.size() != model.nodes.size()) fail(scene, "its nodes form a cycle, or one is a child twice");
  return order;
}

/// World matrix of every node.
std::vector<Mat4> world_matrices(const Scene& scene, const tinygltf::Model& model) {
  std::vector<int> parent;
  std::vector<Mat4> world(model.nodes.size(), Mat4::Identity());
  for (size_t n : parents_first(scene, model, parent)) {
    world[n] = local_matrix(model.nodes[n]);
    if (parent[n] >= 0) world[n] = world[static_cast<size_t>(parent[n])] * world[n];
  }
  return world;
}

/// A skinned mesh ignores its node: in the bind pose every joint carries it alike, so the first one tells.
Mat4 skin_matrix(const tinygltf::Model& model, int skin, const std::vector<Mat4>& world,
                 const std::string& path) {
  if (skin >= static_cast<int>(model.skins.size()) || model.skins[static_cast<size_t>(skin)].joints.empty())
    return Mat4::Identity();
  const tinygltf::Skin& bones = model.skins[static_cast<size_t>(skin)];
  Mat4 inverse_bind = Mat4::Identity();
  if (bones.inverseBindMatrices >= 0) {
    const std::vector<float> values = gltf::decode_floats(model, bones.inverseBindMatrices, path + ": skin");
    for (size_t i = 0; i < 16 && values.size() >= 16; ++i)
      inverse_bind(static_cast<int>(i % 4), static_cast<int>(i / 4)) = static_cast<double>(values[i]);
  }
  const int joint = bones.joints[0];
  return joint >= 0 && joint < static_cast<int>(world.size())
             ? Mat4(world[static_cast<size_t>(joint)] * inverse_bind)
             : Mat4(Mat4::Identity());
}

/// Numbers of a vertex attribute, as many as `width` an element.
std::vector<float> attribute(const tinygltf::Model& model, int accessor, size_t width,
                             const std::string& path) {
  const size_t has = gltf::accessor_view(model, accessor, path).components;
  if (has != width)
    throw Error(path + ": it has " + std::to_string(has) + " numbers an element where " +
                std::to_string(width) + " are due");
  return gltf::decode_floats(model, accessor, path);
}

/// Adds what the default weights of morph targets say: the shape that every viewer shows.
void apply_default_morphs(const tinygltf::Model& model, const tinygltf::Primitive& primitive,
                          const std::vector<double>& weights, std::vector<float>& positions,
                          const std::string& path) {
  for (size_t t = 0; t < std::min(weights.size(), primitive.targets.size()); ++t) {
    const auto delta = primitive.targets[t].find("POSITION");
    if (weights[t] == 0.0 || delta == primitive.targets[t].end()) continue;
    const std::vector<float> values =
        attribute(model, delta->second, 3, path + " target " + std::to_string(t));
    if (values.size() != positions.size())
      throw Error(path + " target " + std::to_string(t) +
                  ": it has another number of vertices than the mesh");
    for (size_t i = 0; i < positions.size(); ++i)
      positions[i] += static_cast<float>(weights[t]) * values[i];
  }
}

void read_primitive(const tinygltf::Model& model, const tinygltf::Primitive& primitive,
                    const std::vector<double>& weights, SceneMesh& mesh, const std::string& path) {
  const auto at = primitive.attributes.find("POSITION");
  if (at == primitive.attributes.end()) throw Error(path + ": it has no POSITION");
  std::vector<float> raw = attribute(model, at->second, 3, path + "/POSITION");
  apply_default_morphs(model, primitive, weights, raw, path);
  for (size_t i = 0; i + 2 < raw.size(); i += 3) {
    const Eigen::Vector4d p = mesh.to_file * Eigen::Vector4d(raw[i], raw[i + 1], raw[i + 2], 1.0);
    mesh.positions.push_back(p.head<3>());
  }
  if (const auto uv = primitive.attributes.find("TEXCOORD_0"); uv != primitive.attributes.end()) {
    const std::vector<float> values = attribute(model, uv->second, 2, path + "/TEXCOORD_0");
    for (size_t i = 0; i + 1 < values.size(); i += 2)
      mesh.uvs.emplace_back(values[i], values[i + 1]);
    if (mesh.uvs.size() != mesh.positions.size()) mesh.uvs.clear();
  }
  if (primitive.material >= 0 && primitive.material < static_cast<int>(model.materials.size()))
    mesh.material = model.materials[static_cast<size_t>(primitive.material)].name;
  // A node that mirrors turns its triangles over (glTF 2.0, section 3.7.4).
  const bool mirrors = is_mirroring(mesh.to_file);
  for (const gltf::Triangle& t : gltf::decode_triangles(model, primitive, mesh.positions.size(), path)) {
    // Degenerate triangles of strips are stitching, not surface.
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
    mesh.triangles.push_back(
        {static_cast<int>(t[0]), static_cast<int>(t[mirrors ? 2 : 1]), static_cast<int>(t[mirrors ? 1 : 2])});
  }
}

/// Extensions that change no geometry that is read here (how things look, sound, move or are lit, and what is
/// noted of them), or that have been undone.
bool is_harmless(const std::string& extension) {
  static const std::array<std::string, 16> known = {"KHR_mesh_quantization",    "KHR_lights_punctual",
                                                    "KHR_animation_pointer",    "KHR_interactivity",
                                                    "KHR_node_hoverability",    "KHR_node_selectability",
                                                    "KHR_techniques_webgl",     "EXT_lights_ies",
                                                    "EXT_lights_image_based",   "EXT_mesh_features",
                                                    "EXT_structural_metadata",  "EXT_instance_features",
                                                    "CESIUM_primitive_outline", "FB_geometry_metadata",
                                                    "GODOT_single_root",        "MSFT_lod"};
  for (const char* family : {"KHR_materials_", "KHR_texture_", "KHR_xmp", "KHR_audio", "KHR_physics_",
                             "EXT_texture_", "EXT_materials_", "MSFT_texture_", "MSFT_packing_",
                             "ADOBE_materials_", "NV_materials_", "OMI_", "VRM", "FASCIA_"})
    if (extension.rfind(family, 0) == 0) return true;
  return std::find(known.begin(), known.end(), extension) != known.end();
}

/// A reader must not guess at a file that requires what it does not know (glTF 2.0, section 3.12).
void check_extensions(const Scene& scene, const gltf::Json& root) {
  std::string unknown;
  for (const gltf::Json& extension : root.value("extensionsRequired", gltf::Json::array()))
    if (extension.is_string() && !is_harmless(extension.get<std::string>()))
      unknown += (unknown.empty() ? "" : ", ") + extension.get<std::string>();
  if (!unknown.empty())
    fail(scene,
         "extensionsRequired: the file cannot be read without " + unknown +
             ", which is not known here and may change the head's shape: export it without that extension");
}

/// glTF's major versions are other formats, in which the same names mean other things.
void check_version(const Scene& scene, const gltf::Json& root) {
  const auto asset = root.is_object() ? root.find("asset") : root.end();
  if (!root.is_object() || asset == root.end()) fail(scene, "it is JSON, but not glTF: 'asset' is missing");
  const gltf::Json version =
      asset->is_object() ? asset->value("version", gltf::Json("2.0")) : gltf::Json("2.0");
  const std::string text = version.is_string() ? version.get<std::string>() : version.dump();
  if (text.rfind("2.", 0) != 0 && text != "2")
    fail(scene, "it is glTF " + text + ", and 2.0 is read: export it as glTF 2.0");
}

void read_document(Scene& scene, const std::vector<uint8_t>& bytes, const ReadOptions& options) {
  const std::string name = "'" + scene.path.string() + "'";
  gltf::Document document = gltf::is_glb(bytes) ? gltf::glb_document(bytes, name)
                                                : gltf::Document{{bytes.begin(), bytes.end()}, {}};
  check_version(scene, gltf::parsed(document.json, name));
  const auto resolve = [&](const std::string& relative) -> gltf::OutsideFile {
    FileBeside file = read_beside(scene.path, relative, options.outside);
    return {std::move(file.bytes), std::move(file.why)};
  };
  scene.document = gltf::self_contained(std::move(document), resolve, name, &scene.warnings);
  gltf::Json root = gltf::parsed(scene.document.json, name);
  check_extensions(scene, root);
  if (const size_t added = gltf::separate_instances(root)) {
    scene.document.json = gltf::text_of(root);
    scene.warnings.push_back(
        std::to_string(added) +
        " nodes share a mesh with another node; each was given a copy of its own to move");
  }
}

SceneMesh mesh_of(const tinygltf::Model& model, size_t n, size_t p, const std::vector<Mat4>& world,
                  const std::string& file) {
  const tinygltf::Node& node = model.nodes[n];
  const tinygltf::Mesh& source = model.meshes[static_cast<size_t>(node.mesh)];
  SceneMesh mesh;
  mesh.name = !source.name.empty() ? source.name
              : !node.name.empty() ? node.name
                                   : "mesh_" + std::to_string(node.mesh);
  mesh.mesh = node.mesh;
  mesh.primitive = static_cast<int>(p);
  mesh.node = static_cast<int>(n);
  const std::string path = file + ": mesh '" + mesh.name + "' primitive " + std::to_string(p);
  mesh.to_file = node.skin >= 0 ? skin_matrix(model, node.skin, world, file) : world[n];
  read_primitive(model, source.primitives[p], node.weights.empty() ? source.weights : node.weights, mesh,
                 path);
  return mesh;
}

}  // namespace

void read_gltf(Scene& scene, const std::vector<uint8_t>& bytes, const ReadOptions& options) {
  read_document(scene, bytes, options);
  const std::string file = "'" + scene.path.string() + "'";
  const tinygltf::Model model =
      gltf::load_model(gltf::glb_bytes(scene.document.json, scene.document.bin), file);
  const std::vector<Mat4> world = world_matrices(scene, model);
  for (size_t n = 0; n < model.nodes.size(); ++n) {
    const tinygltf::Node& node = model.nodes[n];
    if (node.mesh < 0) continue;
    if (node.mesh >= static_cast<int>(model.meshes.size()))
      fail(scene, "a node names a mesh that is not there");
    const std::vector<tinygltf::Primitive>& primitives =
        model.meshes[static_cast<size_t>(node.mesh)].primitives;
    for (size_t p = 0; p < primitives.size(); ++p) {
      const int mode = primitives[p].mode;
      if (mode >= 0 && mode < TINYGLTF_MODE_TRIANGLES) continue;  // points and lines are not surface
      scene.meshes.push_back(mesh_of(model, n, p, world, file));
    }
  }
}

}  // namespace fascia::formats::detail
