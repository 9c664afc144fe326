#include <map>

#include "geometry/error.h"
#include "gltf/edit/animation.h"
#include "gltf/edit/morph_targets.h"
#include "gltf/edit/shading.h"
#include "gltf/read/model.h"

namespace fascia::gltf {
namespace {

/// What the default weights of a primitive's targets add to its positions, #vertices; nothing when they are
/// off.
std::vector<Vec3f> morphed_by_default(const Edit& edit, const tinygltf::Model& model, uint32_t mesh,
                                      const tinygltf::Primitive& primitive) {
  const std::vector<std::size_t> nodes = edit.nodes_of(mesh);
  std::vector<Vec3f> sum;
  if (nodes.empty()) return sum;
  const std::vector<float> weights =
      default_weights(edit.json, edit.json["nodes"][nodes.front()], primitive.targets.size());
  for (std::size_t t = 0; t < primitive.targets.size(); ++t) {
    const auto delta = primitive.targets[t].find("POSITION");
    if (weights[t] == 0.0F || delta == primitive.targets[t].end()) continue;
    const std::vector<float> values = decode_floats(model, delta->second, "mesh " + std::to_string(mesh));
    sum.resize(values.size() / 3, Vec3f::Zero());
    for (std::size_t v = 0; v < sum.size(); ++v)
      sum[v] += weights[t] * Vec3f(values[3 * v], values[3 * v + 1], values[3 * v + 2]);
  }
  return sum;
}

std::span<const float> flat(const std::vector<Vec3f>& vectors) {
  return {reinterpret_cast<const float*>(vectors.data()), 3 * vectors.size()};
}

/// One mesh put into a pose: by primitive the positions to store, none where it stands still.
void put_pose(Edit& edit, const MeshShading& shading, uint32_t mesh,
              const std::vector<std::vector<Vec3f>>& positions) {
  std::vector<std::vector<Vec3f>> moves = positions;
  for (std::size_t p = 0; p < moves.size(); ++p)
    for (std::size_t v = 0; v < moves[p].size(); ++v)
      moves[p][v] -= shading.primitives()[p].positions[v];
  const MeshShading::Turned turned = shading.turned(moves);
  for (std::size_t p = 0; p < positions.size(); ++p) {
    if (positions[p].empty()) continue;
    Json attributes = edit.primitive(mesh, static_cast<uint32_t>(p))["attributes"];
    attributes["POSITION"] = edit.add_floats(flat(positions[p]), 3, true, vertex_target);
    attributes["NORMAL"] = edit.add_floats(flat(turned.normals[p]), 3, false, vertex_target);
    std::vector<float> tangents;
    for (std::size_t v = 0; v < turned.tangents[p].size(); ++v)
      for (int k = 0; k < 4; ++k)
        tangents.push_back(k < 3 ? turned.tangents[p][v][k] : shading.primitives()[p].tangents[v][3]);
    if (!tangents.empty()) attributes["TANGENT"] = edit.add_floats(tangents, 4, false, vertex_target);
    edit.primitive(mesh, static_cast<uint32_t>(p))["attributes"] = std::move(attributes);
  }
}

}  // namespace

void set_pose(Edit& edit, const std::vector<PosedPrimitive>& posed) {
  const tinygltf::Model& model = edit.model();
  std::map<uint32_t, std::vector<std::vector<Vec3f>>> meshes;
  for (const PosedPrimitive& seen : posed) {
    edit.primitive(seen.mesh, seen.primitive);  // throws when it is not there
    const std::vector<tinygltf::Primitive>& primitives = model.meshes[seen.mesh].primitives;
    std::vector<std::vector<Vec3f>>& positions = meshes[seen.mesh];
    positions.resize(primitives.size());
    const std::vector<Vec3f> morphed = morphed_by_default(edit, model, seen.mesh, primitives[seen.primitive]);
    for (std::size_t i = 0; i + 2 < seen.positions.size(); i += 3) {
      const Vec3f place(seen.positions[i], seen.positions[i + 1], seen.positions[i + 2]);
      positions[seen.primitive].push_back(i / 3 < morphed.size() ? Vec3f(place - morphed[i / 3]) : place);
    }
  }
  for (const auto& [mesh, positions] : meshes) {
    const MeshShading shading = mesh_shading(model, mesh);
    for (std::size_t p = 0; p < positions.size(); ++p)
      if (!positions[p].empty() && positions[p].size() != shading.primitives()[p].positions.size())
        throw Error("mesh " + std::to_string(mesh) + " primitive " + std::to_string(p) +
                    ": the pose has another number of vertices: build the rig again");
    put_pose(edit, shading, mesh, positions);
  }
}

}  // namespace fascia::gltf
