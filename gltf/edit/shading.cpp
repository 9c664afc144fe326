#include "gltf/edit/shading.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <map>

#include "geometry/alignment.h"
#include "geometry/error.h"

namespace fascia::gltf {
namespace {

Vec3f unit_or(const Vec3f& v, const Vec3f& otherwise) {
  const float length = v.norm();
  return length > 0.0F && std::isfinite(length) ? Vec3f(v / length) : otherwise;
}

/// Columns: two edges of a triangle and its unit normal; singular for a degenerate one.
Eigen::Matrix3f triangle_frame(const std::vector<Vec3f>& positions, const Triangle& t) {
  Eigen::Matrix3f frame;
  frame.col(0) = positions[t[1]] - positions[t[0]];
  frame.col(1) = positions[t[2]] - positions[t[0]];
  frame.col(2) = unit_or(frame.col(0).cross(frame.col(1)), Vec3f::Zero());
  return frame;
}

std::vector<Vec3f> vectors(const tinygltf::Model& model, int accessor, const std::string& path) {
  const std::vector<float> flat = decode_floats(model, accessor, path);
  std::vector<Vec3f> result(flat.size() / 3);
  for (std::size_t i = 0; i < result.size(); ++i)
    result[i] = Vec3f(flat[3 * i], flat[3 * i + 1], flat[3 * i + 2]);
  return result;
}

int attribute(const tinygltf::Primitive& primitive, const char* name) {
  const auto found = primitive.attributes.find(name);
  return found == primitive.attributes.end() ? -1 : found->second;
}

ShadedPrimitive shaded_primitive(const tinygltf::Model& model, const tinygltf::Primitive& primitive,
                                 const std::string& path) {
  ShadedPrimitive shaded;
  if (attribute(primitive, "POSITION") < 0) throw Error(path + ": it has no POSITION");
  shaded.positions = vectors(model, attribute(primitive, "POSITION"), path);
  if (attribute(primitive, "NORMAL") >= 0)
    shaded.normals = vectors(model, attribute(primitive, "NORMAL"), path);
  if (attribute(primitive, "TANGENT") >= 0) {
    const std::vector<float> flat = decode_floats(model, attribute(primitive, "TANGENT"), path);
    for (std::size_t i = 0; i + 3 < flat.size(); i += 4)
      shaded.tangents.emplace_back(flat[i], flat[i + 1], flat[i + 2], flat[i + 3]);
    if (shaded.tangents.size() != shaded.positions.size()) shaded.tangents.clear();
  }
  shaded.triangles = decode_triangles(model, primitive, shaded.positions.size(), path);
  return shaded;
}

}  // namespace

MeshShading::MeshShading(std::vector<ShadedPrimitive> primitives) : primitives_(std::move(primitives)) {
  std::map<std::array<float, 3>, uint32_t> known;
  std::vector<std::vector<Vec3f>> positions;
  for (const ShadedPrimitive& primitive : primitives_) {
    place_.emplace_back();
    for (const Vec3f& p : primitive.positions)
      place_.back().push_back(
          known.try_emplace({p.x(), p.y(), p.z()}, static_cast<uint32_t>(known.size())).first->second);
    positions.push_back(primitive.positions);
  }
  places_ = known.size();
  rest_ = surface_normals(positions);
  for (std::size_t p = 0; p < primitives_.size(); ++p) {
    ShadedPrimitive& primitive = primitives_[p];
    primitive.has_normals =
        primitive.normals.size() == primitive.positions.size() && !primitive.normals.empty();
    if (primitive.has_normals) continue;
    primitive.normals.clear();
    primitive.tangents.clear();  // without normals they have no meaning (glTF 2.0, section 3.7.2.1)
    for (const uint32_t place : place_[p])
      primitive.normals.push_back(unit_or(rest_[place], Vec3f::UnitZ()));
  }
}

std::vector<Vec3f> MeshShading::surface_normals(const std::vector<std::vector<Vec3f>>& positions) const {
  std::vector<Vec3f> normals(places_, Vec3f::Zero());
  for (std::size_t p = 0; p < primitives_.size(); ++p)
    for (const Triangle& t : primitives_[p].triangles) {
      const Vec3f& a = positions[p][t[0]];
      const Vec3f area = (positions[p][t[1]] - a).cross(positions[p][t[2]] - a);
      for (const uint32_t corner : t)
        normals[place_[p][corner]] += area;
    }
  for (Vec3f& normal : normals)
    normal = unit_or(normal, Vec3f::Zero());
  return normals;
}

std::vector<std::vector<Vec3f>> MeshShading::moved(
    const std::vector<std::vector<Vec3f>>& displacements) const {
  std::vector<std::vector<Vec3f>> positions;
  for (std::size_t p = 0; p < primitives_.size(); ++p) {
    positions.push_back(primitives_[p].positions);
    for (std::size_t v = 0; v < displacements[p].size(); ++v)
      positions[p][v] += displacements[p][v];
  }
  return positions;
}

MeshShading::Turned MeshShading::turned(const std::vector<std::vector<Vec3f>>& displacements) const {
  const std::vector<std::vector<Vec3f>> positions = moved(displacements);
  const std::vector<Vec3f> surface = surface_normals(positions);
  Turned result;
  for (std::size_t p = 0; p < primitives_.size(); ++p) {
    const ShadedPrimitive& primitive = primitives_[p];
    std::vector<Vec3f> normals = primitive.normals;
    for (std::size_t v = 0; v < normals.size(); ++v) {
      const Vec3f &before = rest_[place_[p][v]], &after = surface[place_[p][v]];
      if (before == after || before.isZero(0) || after.isZero(0)) continue;
      normals[v] = unit_or(least_rotation(before, after) * primitive.normals[v], normals[v]);
    }
    result.tangents.push_back(primitive.tangents.empty() ? std::vector<Vec3f>()
                                                         : turned_tangents(p, positions[p], normals));
    result.normals.push_back(std::move(normals));
  }
  return result;
}

std::vector<Vec3f> MeshShading::turned_tangents(std::size_t primitive, const std::vector<Vec3f>& positions,
                                                const std::vector<Vec3f>& normals) const {
  const ShadedPrimitive& rest = primitives_[primitive];
  std::vector<Vec3f> carried(positions.size(), Vec3f::Zero());
  std::vector<bool> moves(positions.size(), false);
  for (const Triangle& t : rest.triangles) {
    const Eigen::Matrix3f before = triangle_frame(rest.positions, t), after = triangle_frame(positions, t);
    const float area = before.col(0).cross(before.col(1)).norm();
    const Eigen::Matrix3f map = before == after || !(area > 0.0F)
                                    ? Eigen::Matrix3f(Eigen::Matrix3f::Identity())
                                    : Eigen::Matrix3f(after * before.inverse());
    for (const uint32_t corner : t) {
      if (before != after) moves[corner] = true;
      if (map.allFinite()) carried[corner] += area * (map * rest.tangents[corner].head<3>());
    }
  }
  std::vector<Vec3f> tangents;
  for (std::size_t v = 0; v < positions.size(); ++v) {
    const Vec3f own = rest.tangents[v].head<3>();
    const Vec3f square = carried[v] - normals[v] * normals[v].dot(carried[v]);
    tangents.push_back(moves[v] ? unit_or(square, own) : own);
  }
  return tangents;
}

MeshShading mesh_shading(const tinygltf::Model& model, uint32_t mesh) {
  const std::string path = "mesh " + std::to_string(mesh);
  if (mesh >= model.meshes.size()) throw Error(path + " is not in the file");
  std::vector<ShadedPrimitive> primitives;
  for (const tinygltf::Primitive& primitive : model.meshes[mesh].primitives)
    primitives.push_back(shaded_primitive(model, primitive, path));
  return MeshShading(std::move(primitives));
}

}  // namespace fascia::gltf
