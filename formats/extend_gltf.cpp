#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "formats/detail.h"
#include "formats/extend_detail.h"
#include "geometry/error.h"
#include "gltf/edit/edit.h"
#include "gltf/edit/raw_numbers.h"

namespace fascia::formats::detail {

namespace {

using gltf::Json;

std::optional<gltf::RawNumbers> numbers_of(const gltf::Edit& edit, size_t accessor, size_t count) {
  return gltf::raw_numbers(edit.json, edit.binary(), accessor, count);
}

size_t append(gltf::Edit& edit, const gltf::RawNumbers& numbers, size_t like, bool is_sparse = false) {
  return gltf::append_like(edit.json, edit.data(), numbers, like, gltf::vertex_target, is_sparse);
}

/// A direction of the file in a primitive's own axes.
Vec3 to_primitive(const SceneMesh& mesh, const Vec3& normal) {
  const Mat3 linear = mesh.to_file.topLeftCorner<3, 3>();
  const Vec3 own = linear.transpose() * normal;
  return own.norm() > 0.0 ? Vec3(own.normalized()) : normal;
}

double length_one(const Json& accessor) {
  if (!accessor.value("normalized", false)) return 1.0;
  switch (accessor["componentType"].get<int>()) {
    case gltf::int8:
      return 127.0;
    case gltf::uint8:
      return 255.0;
    case gltf::int16:
      return 32767.0;
    default:
      return 65535.0;
  }
}

/// Appends what lies between the two vertices that each appended one lies between.
void extend_between(gltf::RawNumbers& numbers, const MeshExtension& extension) {
  const bool is_whole = numbers.component != gltf::float32;
  for (const AppendedVertex& vertex : extension.vertices)
    for (size_t k = 0; k < numbers.width; ++k) {
      const double value = (1.0 - vertex.share) * numbers.at(static_cast<size_t>(vertex.a))[k] +
                           vertex.share * numbers.at(static_cast<size_t>(vertex.b))[k];
      numbers.values.push_back(is_whole ? std::round(value) : value);
    }
}

void make_unit(double* v, double length) {
  const double norm = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  for (size_t k = 0; norm > 0.0 && k < 3; ++k)
    v[k] *= length / norm;
}

/// Joints and weights of all sets at once: the strongest of both ends' joints.
void extend_skin(std::vector<gltf::RawNumbers>& joints, std::vector<gltf::RawNumbers>& weights, double one,
                 const MeshExtension& extension) {
  for (const AppendedVertex& vertex : extension.vertices) {
    std::map<double, double> sum;
    for (const bool is_b : {false, true}) {
      const auto v = static_cast<size_t>(is_b ? vertex.b : vertex.a);
      const double share = is_b ? vertex.share : 1.0 - vertex.share;
      for (size_t s = 0; s < joints.size(); ++s)
        for (size_t k = 0; k < 4; ++k)
          if (weights[s].at(v)[k] > 0.0) sum[joints[s].at(v)[k]] += share * weights[s].at(v)[k];
    }
    std::vector<std::pair<double, double>> strongest(sum.begin(), sum.end());
    std::stable_sort(strongest.begin(), strongest.end(),
                     [](const auto& a, const auto& b) { return a.second > b.second; });
    strongest.resize(4 * joints.size(), {0.0, 0.0});
    double total = 0.0;
    for (const auto& [joint, weight] : strongest)
      total += weight;
    double left = one;
    for (size_t i = strongest.size(); i-- > 1;) {
      double& weight = strongest[i].second;
      weight = total > 0.0 ? weight * one / total : 0.0;
      if (weights[0].component != gltf::float32) weight = std::round(weight);
      left -= weight;
    }
    strongest[0].second = left;
    for (size_t i = 0; i < strongest.size(); ++i) {
      joints[i / 4].values.push_back(strongest[i].first);
      weights[i / 4].values.push_back(strongest[i].second);
    }
  }
}

void extend_attributes(gltf::Edit& edit, const SceneMesh& mesh, const MeshExtension& extension,
                       Json& attributes) {
  std::vector<gltf::RawNumbers> joints, weights;
  std::vector<std::string> joint_names, weight_names;
  double one = 1.0;
  for (auto& [name, index] : attributes.items()) {
    const auto accessor = index.get<size_t>();
    const size_t first = static_cast<size_t>(extension.vertices_before);
    std::optional<gltf::RawNumbers> read = numbers_of(edit, accessor, first);
    if (!read) continue;
    gltf::RawNumbers& numbers = *read;
    if (name.rfind("JOINTS_", 0) == 0) {
      joints.push_back(std::move(numbers));
      joint_names.push_back(name);
      continue;
    }
    if (name.rfind("WEIGHTS_", 0) == 0) {
      one = length_one(edit.json["accessors"].at(accessor));
      weights.push_back(std::move(numbers));
      weight_names.push_back(name);
      continue;
    }
    extend_between(numbers, extension);
    const double unit = length_one(edit.json["accessors"].at(accessor));
    for (size_t i = 0; i < extension.vertices.size(); ++i) {
      double* value = numbers.at(first + i);
      if (name == "POSITION") {
        const Mat4 from_file = mesh.to_file.inverse();
        const AppendedVertex& vertex = extension.vertices[i];
        const Vec3 p = transform_point(from_file, mesh.positions[first + i]);
        // `positions` have the default morphs applied, the accessor has not: both ends tell by how much.
        const Vec3 ends =
            transform_point(from_file, (1.0 - vertex.share) * mesh.positions[static_cast<size_t>(vertex.a)] +
                                           vertex.share * mesh.positions[static_cast<size_t>(vertex.b)]);
        for (size_t k = 0; k < 3; ++k)
          value[k] = numbers.component == gltf::float32
                         ? value[k] + p[static_cast<Eigen::Index>(k)] - ends[static_cast<Eigen::Index>(k)]
                         : p[static_cast<Eigen::Index>(k)];
        // Quantised positions (KHR_mesh_quantization) are carried by the node's transform.
        for (size_t k = 0; numbers.component != gltf::float32 && k < 3; ++k)
          value[k] = std::round(value[k] * unit);
      } else if (name == "NORMAL" || name == "TANGENT") {
        if (name == "NORMAL" && extension.vertices[i].normal) {
          const Vec3 n = to_primitive(mesh, *extension.vertices[i].normal);
          std::copy_n(n.data(), 3, value);
        }
        make_unit(value, unit);
        if (name == "TANGENT") value[3] = numbers.at(static_cast<size_t>(extension.vertices[i].a))[3];
      }
    }
    attributes[name] = append(edit, numbers, accessor);
  }
  if (joints.empty() || joints.size() != weights.size()) return;
  extend_skin(joints, weights, one, extension);
  for (size_t s = 0; s < joints.size(); ++s) {
    attributes[joint_names[s]] = append(edit, joints[s], attributes[joint_names[s]].get<size_t>());
    attributes[weight_names[s]] = append(edit, weights[s], attributes[weight_names[s]].get<size_t>());
  }
}

void extend_primitive(gltf::Edit& edit, const SceneMesh& mesh, const MeshExtension& extension) {
  Json primitive = edit.json["meshes"].at(static_cast<size_t>(mesh.mesh))["primitives"].at(
      static_cast<size_t>(mesh.primitive));
  extend_attributes(edit, mesh, extension, primitive["attributes"]);
  if (primitive.contains("targets"))
    for (Json& target : primitive["targets"])
      for (auto& [name, index] : target.items()) {
        std::optional<gltf::RawNumbers> numbers =
            numbers_of(edit, index.get<size_t>(), static_cast<size_t>(extension.vertices_before));
        if (!numbers) continue;
        extend_between(*numbers, extension);
        target[name] = append(edit, *numbers, index.get<size_t>(), true);
      }
  const bool mirrors = is_mirroring(mesh.to_file);
  std::vector<uint32_t> corners;
  for (Triangle t : mesh.triangles) {
    if (mirrors) std::swap(t[1], t[2]);  // as the file's own
    corners.insert(corners.end(), t.begin(), t.end());
  }
  primitive["indices"] = edit.data().add_indices(corners);
  primitive.erase("mode");
  edit.json["meshes"][static_cast<size_t>(mesh.mesh)]["primitives"][static_cast<size_t>(mesh.primitive)] =
      primitive;
}

std::vector<float> as_floats(const std::vector<Vec3>& vectors) {
  std::vector<float> floats;
  for (const Vec3& v : vectors)
    for (const double x : v)
      floats.push_back(static_cast<float>(x));
  return floats;
}

/// A mesh of its own under a node of its own, in the file's axes and units.
void add_primitive(gltf::Edit& edit, SceneMesh& mesh, const Vec3& offset) {
  Json attributes;
  const auto add = [&](const std::vector<Vec3>& vectors, bool bounds) {
    return edit.data().add_floats(as_floats(vectors), 3, bounds, gltf::vertex_target);
  };
  attributes["POSITION"] = add(mesh.positions, true);
  std::vector<Vec3> normals = vertex_normals({mesh.positions, mesh.triangles});
  for (Vec3& n : normals)
    if (!(n.norm() > 0.5)) n = Vec3::UnitZ();
  attributes["NORMAL"] = add(normals, false);
  if (mesh.colours.size() == mesh.positions.size()) attributes["COLOR_0"] = add(mesh.colours, false);
  std::vector<uint32_t> corners;
  for (const Triangle& t : mesh.triangles)
    corners.insert(corners.end(), t.begin(), t.end());
  Json primitive = {{"attributes", attributes}, {"indices", edit.data().add_indices(corners)}};
  Json& json = edit.json;
  json["materials"].push_back(
      {{"name", mesh.material},
       {"pbrMetallicRoughness", {{"metallicFactor", 0.0}, {"roughnessFactor", 0.4}}}});
  primitive["material"] = json["materials"].size() - 1;
  json["meshes"].push_back({{"name", mesh.name}, {"primitives", Json::array({primitive})}});
  mesh.mesh = static_cast<int>(json["meshes"].size()) - 1;
  mesh.primitive = 0;
  json["nodes"].push_back({{"name", mesh.name}, {"mesh", mesh.mesh}});
  if (!offset.isZero(0)) json["nodes"].back()["translation"] = {offset[0], offset[1], offset[2]};
  mesh.node = static_cast<int>(json["nodes"].size()) - 1;
  if (!json.contains("scenes") || json["scenes"].empty()) json["scenes"] = Json::array({Json::object()});
  const size_t shown = std::min(json.value("scene", size_t{0}), json["scenes"].size() - 1);
  json["scenes"][shown]["nodes"].push_back(mesh.node);
}

}  // namespace

void rewrite_gltf(Scene& scene, const std::vector<MeshExtension>& extensions) {
  try {
    gltf::Edit edit(scene.document);
    std::set<std::pair<int, int>> done;
    for (size_t m = 0; m < extensions.size(); ++m)
      if (extensions[m].changed() && done.insert({scene.meshes[m].mesh, scene.meshes[m].primitive}).second)
        extend_primitive(edit, scene.meshes[m], extensions[m]);
    for (size_t m = extensions.size(); m < scene.meshes.size(); ++m)
      add_primitive(edit, scene.meshes[m], scene.offset);
    scene.document = edit.document();
  } catch (const nlohmann::json::exception& error) {
    fail(scene, std::string("its glTF JSON does not fit its meshes: ") + error.what());
  } catch (const Error& error) {
    fail(scene, error.what());
  }
}

}  // namespace fascia::formats::detail
