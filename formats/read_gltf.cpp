#include <Eigen/Geometry>
#include <functional>

#include "cmake/tinygltf/tinygltf.h"
#include "formats/detail.h"
#include "formats/gltf_document.h"
#include "geometry/error.h"

namespace fascia::formats::detail {

namespace {

/// Reads element `i` of accessors as doubles, with every bound checked.
class AccessorReader {
 public:
  AccessorReader(const Scene& scene, const tinygltf::Model& model) : scene_(scene), model_(model) {}

  /// All elements of accessor `index`, `width` numbers each.
  std::vector<double> read(int index, int width) const {
    if (index < 0 || index >= static_cast<int>(model_.accessors.size()))
      fail(scene_, "it names accessor " + std::to_string(index) + ", which is not there");
    const tinygltf::Accessor& accessor = model_.accessors[static_cast<size_t>(index)];
    if (tinygltf::GetNumComponentsInType(static_cast<uint32_t>(accessor.type)) != width)
      fail(scene_, "accessor " + std::to_string(index) + " has the wrong type");
    const size_t limit = 1U << 28;
    if (accessor.count > limit) fail(scene_, "accessor " + std::to_string(index) + " is impossibly large");
    std::vector<double> values(accessor.count * static_cast<size_t>(width), 0.0);
    if (accessor.bufferView >= 0)
      read_view(accessor.bufferView, accessor.byteOffset, accessor.componentType, accessor.normalized,
                accessor.count, width, values);
    if (accessor.sparse.isSparse) apply_sparse(accessor, width, values);
    return values;
  }

 private:
  void read_view(int view_index, size_t offset, int type, bool normalized, size_t count, int width,
                 std::vector<double>& values) const {
    if (view_index < 0 || view_index >= static_cast<int>(model_.bufferViews.size()))
      fail(scene_, "it names bufferView " + std::to_string(view_index) + ", which is not there");
    const tinygltf::BufferView& view = model_.bufferViews[static_cast<size_t>(view_index)];
    if (view.buffer < 0 || view.buffer >= static_cast<int>(model_.buffers.size()))
      fail(scene_, "bufferView " + std::to_string(view_index) + " names a buffer that is not there");
    const std::vector<unsigned char>& data = model_.buffers[static_cast<size_t>(view.buffer)].data;
    const int component = tinygltf::GetComponentSizeInBytes(static_cast<uint32_t>(type));
    if (component <= 0) fail(scene_, "an accessor has the unknown component type " + std::to_string(type));
    const size_t element = static_cast<size_t>(component) * static_cast<size_t>(width);
    const size_t stride = view.byteStride ? view.byteStride : element;
    if (count > 0) {
      const size_t last = offset + stride * (count - 1) + element;
      if (last > view.byteLength || view.byteOffset + last > data.size() || stride > 65536)
        fail(scene_, "an accessor reaches past the end of bufferView " + std::to_string(view_index) +
                         ": the file is damaged or truncated");
    }
    for (size_t i = 0; i < count; ++i)
      for (int k = 0; k < width; ++k)
        values[i * static_cast<size_t>(width) + static_cast<size_t>(k)] =
            component_at(&data[view.byteOffset + offset + stride * i + static_cast<size_t>(component * k)],
                         type, normalized);
  }

  void apply_sparse(const tinygltf::Accessor& accessor, int width, std::vector<double>& values) const {
    const size_t count = static_cast<size_t>(std::max(0, accessor.sparse.count));
    std::vector<double> indices(count), replaced(count * static_cast<size_t>(width));
    read_view(accessor.sparse.indices.bufferView, static_cast<size_t>(accessor.sparse.indices.byteOffset),
              accessor.sparse.indices.componentType, false, count, 1, indices);
    read_view(accessor.sparse.values.bufferView, static_cast<size_t>(accessor.sparse.values.byteOffset),
              accessor.componentType, accessor.normalized, count, width, replaced);
    for (size_t i = 0; i < count; ++i) {
      const size_t at = static_cast<size_t>(indices[i]);
      if (at >= accessor.count) fail(scene_, "a sparse accessor names an element that is not there");
      for (int k = 0; k < width; ++k)
        values[at * static_cast<size_t>(width) + static_cast<size_t>(k)] =
            replaced[i * static_cast<size_t>(width) + static_cast<size_t>(k)];
    }
  }

  template <class T>
  static double as(const unsigned char* raw, double scale) {
    T value;
    std::memcpy(&value, raw, sizeof value);
    const double scaled = static_cast<double>(value) * scale;
    return scale == 1.0 ? scaled : std::max(scaled, -1.0);
  }

  double component_at(const unsigned char* raw, int type, bool normalized) const {
    switch (type) {
      case TINYGLTF_COMPONENT_TYPE_BYTE:
        return as<int8_t>(raw, normalized ? 1.0 / 127 : 1.0);
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return as<uint8_t>(raw, normalized ? 1.0 / 255 : 1.0);
      case TINYGLTF_COMPONENT_TYPE_SHORT:
        return as<int16_t>(raw, normalized ? 1.0 / 32767 : 1.0);
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return as<uint16_t>(raw, normalized ? 1.0 / 65535 : 1.0);
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
        return as<uint32_t>(raw, 1.0);
      case TINYGLTF_COMPONENT_TYPE_FLOAT:
        return as<float>(raw, 1.0);
      default:
        fail(scene_, "an accessor has the unknown component type " + std::to_string(type));
    }
  }

  const Scene& scene_;
  const tinygltf::Model& model_;
};

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

/// World matrix of every node.
std::vector<Mat4> world_matrices(const Scene& scene, const tinygltf::Model& model) {
  std::vector<Mat4> world(model.nodes.size(), Mat4::Identity());
  std::vector<int> parent(model.nodes.size(), -1);
  for (size_t n = 0; n < model.nodes.size(); ++n)
    for (int child : model.nodes[n].children) {
      if (child < 0 || child >= static_cast<int>(model.nodes.size()))
        fail(scene, "a node names a child that is not there");
      parent[static_cast<size_t>(child)] = static_cast<int>(n);
    }
  for (size_t n = 0; n < model.nodes.size(); ++n) {
    Mat4 matrix = local_matrix(model.nodes[n]);
    size_t steps = 0;
    for (int up = parent[n]; up >= 0; up = parent[static_cast<size_t>(up)]) {
      matrix = local_matrix(model.nodes[static_cast<size_t>(up)]) * matrix;
      if (++steps > model.nodes.size()) fail(scene, "its nodes form a cycle");
    }
    world[n] = matrix;
  }
  return world;
}

/// A skinned mesh ignores its node: in the bind pose every joint carries it alike, so the first one tells.
Mat4 skin_matrix(const AccessorReader& accessors, const tinygltf::Model& model, int skin,
                 const std::vector<Mat4>& world) {
  if (skin >= static_cast<int>(model.skins.size()) || model.skins[static_cast<size_t>(skin)].joints.empty())
    return Mat4::Identity();
  const tinygltf::Skin& bones = model.skins[static_cast<size_t>(skin)];
  Mat4 inverse_bind = Mat4::Identity();
  if (bones.inverseBindMatrices >= 0) {
    const std::vector<double> values = accessors.read(bones.inverseBindMatrices, 16);
    if (values.size() >= 16)
      for (int i = 0; i < 16; ++i)
        inverse_bind(i % 4, i / 4) = values[static_cast<size_t>(i)];
  }
  const int joint = bones.joints[0];
  return joint >= 0 && joint < static_cast<int>(world.size())
             ? Mat4(world[static_cast<size_t>(joint)] * inverse_bind)
             : Mat4(Mat4::Identity());
}

void triangles_of(const AccessorReader& accessors, const tinygltf::Primitive& primitive, SceneMesh& mesh) {
  std::vector<int> order;
  if (primitive.indices >= 0) {
    for (double index : accessors.read(primitive.indices, 1))
      order.push_back(static_cast<int>(index));
  } else {
    for (size_t i = 0; i < mesh.positions.size(); ++i)
      order.push_back(static_cast<int>(i));
  }
  const int mode = primitive.mode < 0 ? TINYGLTF_MODE_TRIANGLES : primitive.mode;
  if (mode == TINYGLTF_MODE_TRIANGLES) {
    for (size_t i = 0; i + 2 < order.size(); i += 3)
      mesh.triangles.push_back({order[i], order[i + 1], order[i + 2]});
  } else if (mode == TINYGLTF_MODE_TRIANGLE_STRIP) {
    for (size_t i = 0; i + 2 < order.size(); ++i)
      mesh.triangles.push_back(i % 2 ? Triangle{order[i + 1], order[i], order[i + 2]}
                                     : Triangle{order[i], order[i + 1], order[i + 2]});
  } else if (mode == TINYGLTF_MODE_TRIANGLE_FAN) {
    for (size_t i = 1; i + 1 < order.size(); ++i)
      mesh.triangles.push_back({order[0], order[i], order[i + 1]});
  }
  // Degenerate triangles of strips are stitching, not surface.
  std::erase_if(mesh.triangles,
                [](const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; });
}

void read_primitive(const Scene& scene, const AccessorReader& accessors, const tinygltf::Model& model,
                    const tinygltf::Primitive& primitive, SceneMesh& mesh) {
  for (const char* packed : {"KHR_draco_mesh_compression", "EXT_meshopt_compression"})
    if (primitive.extensions.count(packed))
      fail(scene, "mesh '" + mesh.name + "' is compressed with " + packed +
                      "; save it without compression (for instance gltf-transform copy) and try again");
  const auto at = primitive.attributes.find("POSITION");
  if (at == primitive.attributes.end()) fail(scene, "mesh '" + mesh.name + "' has no POSITION");
  const std::vector<double> raw = accessors.read(at->second, 3);
  for (size_t i = 0; i + 2 < raw.size(); i += 3) {
    const Eigen::Vector4d p = mesh.to_file * Eigen::Vector4d(raw[i], raw[i + 1], raw[i + 2], 1.0);
    mesh.positions.push_back(p.head<3>());
  }
  if (const auto uv = primitive.attributes.find("TEXCOORD_0"); uv != primitive.attributes.end()) {
    const std::vector<double> values = accessors.read(uv->second, 2);
    for (size_t i = 0; i + 1 < values.size(); i += 2)
      mesh.uvs.emplace_back(values[i], values[i + 1]);
    if (mesh.uvs.size() != mesh.positions.size()) mesh.uvs.clear();
  }
  if (primitive.material >= 0 && primitive.material < static_cast<int>(model.materials.size()))
    mesh.material = model.materials[static_cast<size_t>(primitive.material)].name;
  triangles_of(accessors, primitive, mesh);
}

bool ignore_image(tinygltf::Image*, int, std::string*, std::string*, int, int, const unsigned char*, int,
                  void*) {
  return true;
}

tinygltf::Model load_model(const Scene& scene) {
  const std::vector<uint8_t> glb = glb_bytes(scene.document);
  tinygltf::TinyGLTF loader;
  loader.SetImageLoader(&ignore_image, nullptr);
  tinygltf::Model model;
  std::string error, warning;
  if (!loader.LoadBinaryFromMemory(&model, &error, &warning, glb.data(), static_cast<unsigned>(glb.size())) &&
      model.meshes.empty())
    fail(scene, "it is not readable glTF: " + error);
  return model;
}

}  // namespace

void read_gltf(Scene& scene, const std::vector<uint8_t>& bytes) {
  scene.document = gltf_document(scene.path, bytes);
  const tinygltf::Model model = load_model(scene);
  const AccessorReader accessors(scene, model);
  const std::vector<Mat4> world = world_matrices(scene, model);
  for (size_t n = 0; n < model.nodes.size(); ++n) {
    const tinygltf::Node& node = model.nodes[n];
    if (node.mesh < 0) continue;
    if (node.mesh >= static_cast<int>(model.meshes.size()))
      fail(scene, "a node names a mesh that is not there");
    const tinygltf::Mesh& source = model.meshes[static_cast<size_t>(node.mesh)];
    for (size_t p = 0; p < source.primitives.size(); ++p) {
      const int mode = source.primitives[p].mode;
      if (mode >= 0 && mode < TINYGLTF_MODE_TRIANGLES) continue;  // points and lines are not surface
      SceneMesh mesh;
      mesh.name = !source.name.empty() ? source.name
                  : !node.name.empty() ? node.name
                                       : "mesh_" + std::to_string(node.mesh);
      mesh.mesh = node.mesh;
      mesh.primitive = static_cast<int>(p);
      mesh.node = static_cast<int>(n);
      mesh.to_file = node.skin >= 0 ? skin_matrix(accessors, model, node.skin, world) : world[n];
      read_primitive(scene, accessors, model, source.primitives[p], mesh);
      scene.meshes.push_back(std::move(mesh));
    }
  }
}

}  // namespace fascia::formats::detail
