#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <set>

#include "formats/detail.h"
#include "formats/extend_detail.h"

namespace fascia::formats::detail {

namespace {

using Json = nlohmann::ordered_json;

enum Component { int8 = 5120, uint8 = 5121, int16 = 5122, uint16 = 5123, uint32 = 5125, float32 = 5126 };

size_t size_of(int component) {
  return component == int8 || component == uint8 ? 1 : component == int16 || component == uint16 ? 2 : 4;
}

size_t width_of(const std::string& type) {
  if (type == "SCALAR") return 1;
  if (type == "VEC2") return 2;
  if (type == "VEC3") return 3;
  return 4;
}

double number_at(const uint8_t* raw, int component) {
  const auto as = [raw](auto value) {
    std::memcpy(&value, raw, sizeof value);
    return static_cast<double>(value);
  };
  switch (component) {
    case int8:
      return as(int8_t{});
    case uint8:
      return as(uint8_t{});
    case int16:
      return as(int16_t{});
    case uint16:
      return as(uint16_t{});
    case uint32:
      return as(uint32_t{});
    default:
      return as(float{});
  }
}

void put_number(uint8_t* raw, int component, double value) {
  const auto as = [raw](auto number) { std::memcpy(raw, &number, sizeof number); };
  switch (component) {
    case int8:
      return as(static_cast<int8_t>(std::lround(value)));
    case uint8:
      return as(static_cast<uint8_t>(std::lround(value)));
    case int16:
      return as(static_cast<int16_t>(std::lround(value)));
    case uint16:
      return as(static_cast<uint16_t>(std::lround(value)));
    case uint32:
      return as(static_cast<uint32_t>(std::llround(value)));
    default:
      return as(static_cast<float>(value));
  }
}

/// Numbers of an accessor as they stand in it (normalised integers stay integers).
struct Numbers {
  std::vector<double> values;
  size_t width = 1;
  int component = float32;
  size_t count() const { return values.size() / width; }
  double* at(size_t i) { return &values[i * width]; }
  const double* at(size_t i) const { return &values[i * width]; }
};

/// A glTF document whose primitives grow; data are appended, never moved.
class Document {
 public:
  explicit Document(Scene& scene)
      : scene_(scene), json(Json::parse(scene.document.json)), binary_(scene.document.bin) {}

  /// The numbers of accessor `index`, or nothing unless it has `count` elements: no memory is taken for a
  /// count that only the file vouches for.
  std::optional<Numbers> read(size_t index, size_t count) const {
    const Json& accessor = json.at("accessors").at(index);
    if (accessor.at("count").get<size_t>() != count) return std::nullopt;
    Numbers numbers;
    numbers.width = width_of(accessor.at("type").get<std::string>());
    numbers.component = accessor.at("componentType").get<int>();
    numbers.values.assign(count * numbers.width, 0.0);
    if (accessor.contains("bufferView"))
      read_view(accessor["bufferView"].get<size_t>(), accessor.value("byteOffset", size_t{0}),
                numbers.component, numbers.width, count, numbers.values);
    if (accessor.contains("sparse")) {
      const Json& sparse = accessor["sparse"];
      const auto some = sparse.at("count").get<size_t>();
      if (some > count) fail(scene_, "a sparse accessor replaces more elements than it has");
      std::vector<double> places(some), replaced(some * numbers.width);
      const Json &indices = sparse.at("indices"), &values = sparse.at("values");
      read_view(indices.at("bufferView").get<size_t>(), indices.value("byteOffset", size_t{0}),
                indices.at("componentType").get<int>(), 1, some, places);
      read_view(values.at("bufferView").get<size_t>(), values.value("byteOffset", size_t{0}),
                numbers.component, numbers.width, some, replaced);
      for (size_t i = 0; i < some; ++i) {
        const auto at = static_cast<size_t>(places[i]);
        if (at >= count) fail(scene_, "a sparse accessor names an element that is not there");
        std::copy_n(&replaced[i * numbers.width], numbers.width, numbers.at(at));
      }
    }
    return numbers;
  }

  /// Appends `numbers` as a new accessor that is like accessor `like`; of morph targets, which are zero in
  /// most places, only what is not (`is_sparse`).
  size_t add(const Numbers& numbers, size_t like, int target, bool is_sparse = false) {
    Json accessor = json["accessors"].at(like);
    for (const char* gone : {"bufferView", "byteOffset", "sparse"})
      accessor.erase(gone);
    accessor["count"] = numbers.count();
    std::vector<double> places, values;
    for (size_t i = 0; is_sparse && i < numbers.count(); ++i)
      if (std::any_of(numbers.at(i), numbers.at(i) + numbers.width, [](double x) { return x != 0.0; })) {
        places.push_back(static_cast<double>(i));
        values.insert(values.end(), numbers.at(i), numbers.at(i) + numbers.width);
      }
    if (is_sparse && 2 * places.size() < numbers.count()) {
      if (!places.empty())
        accessor["sparse"] = {
            {"count", places.size()},
            {"indices", {{"bufferView", add_view(places, 1, uint32, 0)}, {"componentType", uint32}}},
            {"values", {{"bufferView", add_view(values, numbers.width, numbers.component, 0)}}}};
    } else {
      accessor["bufferView"] = add_view(numbers.values, numbers.width, numbers.component, target);
    }
    if (accessor.contains("min") || accessor.contains("max")) bound(numbers, accessor);
    json["accessors"].push_back(accessor);
    return json["accessors"].size() - 1;
  }

  size_t add_new(const Numbers& numbers, const char* type, int target, bool bounded) {
    Json accessor = {{"bufferView", add_view(numbers.values, numbers.width, numbers.component, target)},
                     {"componentType", numbers.component},
                     {"count", numbers.count()},
                     {"type", type}};
    if (bounded) bound(numbers, accessor);
    json["accessors"].push_back(accessor);
    return json["accessors"].size() - 1;
  }

  void store() {
    binary_.resize((binary_.size() + 3) / 4 * 4);
    if (!json.contains("buffers") || json["buffers"].empty()) json["buffers"] = Json::array({Json::object()});
    json["buffers"][0]["byteLength"] = binary_.size();
    scene_.document.json = json.dump();
    scene_.document.bin = std::move(binary_);
  }

 private:
  Scene& scene_;

 public:
  Json json;

 private:
  static void bound(const Numbers& numbers, Json& accessor) {
    std::vector<double> low(numbers.width, 0.0), high(numbers.width, 0.0);
    for (size_t i = 0; i < numbers.values.size(); ++i) {
      const size_t k = i % numbers.width;
      low[k] = i < numbers.width ? numbers.values[i] : std::min(low[k], numbers.values[i]);
      high[k] = i < numbers.width ? numbers.values[i] : std::max(high[k], numbers.values[i]);
    }
    accessor["min"] = low;
    accessor["max"] = high;
  }

  void read_view(size_t index, size_t offset, int component, size_t width, size_t count,
                 std::vector<double>& values) const {
    const Json& view = json.at("bufferViews").at(index);
    const size_t begin = view.value("byteOffset", size_t{0}), length = view.at("byteLength").get<size_t>(),
                 element = size_of(component) * width, stride = view.value("byteStride", element);
    if (count > 0 && (offset > length || stride > 65536 || element > length - offset ||
                      (count - 1) * stride > length - offset - element || begin > binary_.size() ||
                      length > binary_.size() - begin))
      fail(scene_, "an accessor reaches past the end of bufferView " + std::to_string(index));
    for (size_t i = 0; i < count; ++i)
      for (size_t k = 0; k < width; ++k)
        values[i * width + k] =
            number_at(&binary_[begin + offset + i * stride + k * size_of(component)], component);
  }

  /// Vertex data are aligned to four bytes an element (glTF 2.0, 3.6.2.4).
  size_t add_view(const std::vector<double>& values, size_t width, int component, int target) {
    binary_.resize((binary_.size() + 3) / 4 * 4);
    const size_t element = size_of(component) * width, begin = binary_.size();
    const size_t stride = target == 34962 ? (element + 3) / 4 * 4 : element;
    const size_t count = values.size() / width;
    binary_.resize(begin + count * stride, 0);
    for (size_t i = 0; i < count; ++i)
      for (size_t k = 0; k < width; ++k)
        put_number(&binary_[begin + i * stride + k * size_of(component)], component, values[i * width + k]);
    Json view = {{"buffer", 0}, {"byteOffset", begin}, {"byteLength", count * stride}};
    if (stride != element) view["byteStride"] = stride;
    if (target) view["target"] = target;
    json["bufferViews"].push_back(view);
    return json["bufferViews"].size() - 1;
  }

  std::vector<uint8_t> binary_;
};

/// A direction of the file in a primitive's own axes.
Vec3 to_primitive(const SceneMesh& mesh, const Vec3& normal) {
  const Mat3 linear = mesh.to_file.topLeftCorner<3, 3>();
  const Vec3 own = linear.transpose() * normal;
  return own.norm() > 0.0 ? Vec3(own.normalized()) : normal;
}

double length_one(const Json& accessor) {
  if (!accessor.value("normalized", false)) return 1.0;
  switch (accessor["componentType"].get<int>()) {
    case int8:
      return 127.0;
    case uint8:
      return 255.0;
    case int16:
      return 32767.0;
    default:
      return 65535.0;
  }
}

/// Appends what lies between the two vertices that each appended one lies between.
void extend_between(Numbers& numbers, const MeshExtension& extension) {
  const bool is_whole = numbers.component != float32;
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
void extend_skin(std::vector<Numbers>& joints, std::vector<Numbers>& weights, double one,
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
      if (weights[0].component != float32) weight = std::round(weight);
      left -= weight;
    }
    strongest[0].second = left;
    for (size_t i = 0; i < strongest.size(); ++i) {
      joints[i / 4].values.push_back(strongest[i].first);
      weights[i / 4].values.push_back(strongest[i].second);
    }
  }
}

void extend_attributes(Document& document, const SceneMesh& mesh, const MeshExtension& extension,
                       Json& attributes) {
  std::vector<Numbers> joints, weights;
  std::vector<std::string> joint_names, weight_names;
  double one = 1.0;
  for (auto& [name, index] : attributes.items()) {
    const auto accessor = index.get<size_t>();
    const size_t first = static_cast<size_t>(extension.vertices_before);
    std::optional<Numbers> read = document.read(accessor, first);
    if (!read) continue;
    Numbers& numbers = *read;
    if (name.rfind("JOINTS_", 0) == 0) {
      joints.push_back(std::move(numbers));
      joint_names.push_back(name);
      continue;
    }
    if (name.rfind("WEIGHTS_", 0) == 0) {
      one = length_one(document.json["accessors"].at(accessor));
      weights.push_back(std::move(numbers));
      weight_names.push_back(name);
      continue;
    }
    extend_between(numbers, extension);
    const double unit = length_one(document.json["accessors"].at(accessor));
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
          value[k] = numbers.component == float32
                         ? value[k] + p[static_cast<Eigen::Index>(k)] - ends[static_cast<Eigen::Index>(k)]
                         : p[static_cast<Eigen::Index>(k)];
        // Quantised positions (KHR_mesh_quantization) are carried by the node's transform.
        for (size_t k = 0; numbers.component != float32 && k < 3; ++k)
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
    attributes[name] = document.add(numbers, accessor, 34962);
  }
  if (joints.empty() || joints.size() != weights.size()) return;
  extend_skin(joints, weights, one, extension);
  for (size_t s = 0; s < joints.size(); ++s) {
    attributes[joint_names[s]] = document.add(joints[s], attributes[joint_names[s]].get<size_t>(), 34962);
    attributes[weight_names[s]] = document.add(weights[s], attributes[weight_names[s]].get<size_t>(), 34962);
  }
}

void extend_primitive(Document& document, const SceneMesh& mesh, const MeshExtension& extension) {
  Json primitive = document.json["meshes"].at(static_cast<size_t>(mesh.mesh))["primitives"].at(
      static_cast<size_t>(mesh.primitive));
  extend_attributes(document, mesh, extension, primitive["attributes"]);
  if (primitive.contains("targets"))
    for (Json& target : primitive["targets"])
      for (auto& [name, index] : target.items()) {
        std::optional<Numbers> numbers =
            document.read(index.get<size_t>(), static_cast<size_t>(extension.vertices_before));
        if (!numbers) continue;
        extend_between(*numbers, extension);
        target[name] = document.add(*numbers, index.get<size_t>(), 34962, true);
      }
  Numbers order;
  order.component = mesh.positions.size() > 65535 ? uint32 : uint16;
  const bool mirrors = is_mirroring(mesh.to_file);
  for (Triangle t : mesh.triangles) {
    if (mirrors) std::swap(t[1], t[2]);  // as the file's own
    order.values.insert(order.values.end(), t.begin(), t.end());
  }
  primitive["indices"] = document.add_new(order, "SCALAR", 34963, false);
  primitive.erase("mode");
  document.json["meshes"][static_cast<size_t>(mesh.mesh)]["primitives"][static_cast<size_t>(mesh.primitive)] =
      primitive;
}

Numbers flat(const std::vector<Vec3>& values) {
  Numbers numbers;
  numbers.width = 3;
  for (const Vec3& v : values)
    numbers.values.insert(numbers.values.end(), v.data(), v.data() + 3);
  return numbers;
}

/// A mesh of its own under a node of its own, in the file's axes and units.
void add_primitive(Document& document, SceneMesh& mesh, const Vec3& offset) {
  Json attributes;
  Numbers positions = flat(mesh.positions);
  for (double& x : positions.values)
    x = static_cast<double>(static_cast<float>(x));
  attributes["POSITION"] = document.add_new(positions, "VEC3", 34962, true);
  std::vector<Vec3> normals = vertex_normals({mesh.positions, mesh.triangles});
  for (Vec3& n : normals)
    if (!(n.norm() > 0.5)) n = Vec3::UnitZ();
  attributes["NORMAL"] = document.add_new(flat(normals), "VEC3", 34962, false);
  if (mesh.colours.size() == mesh.positions.size())
    attributes["COLOR_0"] = document.add_new(flat(mesh.colours), "VEC3", 34962, false);
  Numbers order;
  order.component = uint32;
  for (const Triangle& t : mesh.triangles)
    order.values.insert(order.values.end(), t.begin(), t.end());
  Json primitive = {{"attributes", attributes}, {"indices", document.add_new(order, "SCALAR", 34963, false)}};
  Json& json = document.json;
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
    Document document(scene);
    std::set<std::pair<int, int>> done;
    for (size_t m = 0; m < extensions.size(); ++m)
      if (extensions[m].changed() && done.insert({scene.meshes[m].mesh, scene.meshes[m].primitive}).second)
        extend_primitive(document, scene.meshes[m], extensions[m]);
    for (size_t m = extensions.size(); m < scene.meshes.size(); ++m)
      add_primitive(document, scene.meshes[m], scene.offset);
    document.store();
  } catch (const nlohmann::json::exception& error) {
    fail(scene, std::string("its glTF JSON does not fit its meshes: ") + error.what());
  }
}

}  // namespace fascia::formats::detail
