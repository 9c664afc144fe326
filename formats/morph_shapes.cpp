#include "formats/morph_shapes.h"

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "geometry/error.h"
#include "gltf/read/accessors.h"
#include "gltf/read/container.h"
#include "gltf/read/model.h"

namespace fascia::formats {

namespace {

using PlainJson = nlohmann::json;

/// A glTF document with its accessors.
class Accessors {
 public:
  explicit Accessors(const Scene& scene)
      : path_(scene.path.string()),
        gltf_(PlainJson::parse(scene.document.json)),
        model_(gltf::load_model(gltf::glb_bytes(scene.document.json, scene.document.bin), path_)) {}

  const PlainJson& gltf() const { return gltf_; }

  [[noreturn]] void fail(const std::string& what) const { throw Error("'" + path_ + "': " + what); }

  /// All numbers of an accessor.
  std::vector<float> read(size_t index) const {
    return gltf::decode_floats(model_, static_cast<int>(index), "'" + path_ + "'");
  }

 private:
  std::string path_;
  PlainJson gltf_;
  tinygltf::Model model_;
};

std::string target_name(const PlainJson& mesh, size_t target) {
  if (const auto extras = mesh.find("extras"); extras != mesh.end() && extras->is_object())
    if (const auto names = extras->find("targetNames");
        names != extras->end() && names->is_array() && target < names->size() && (*names)[target].is_string())
      return (*names)[target].get<std::string>();
  return "shape_" + std::to_string(target);
}

size_t target_count(const PlainJson& mesh) {
  size_t count = 0;
  for (const PlainJson& primitive : mesh.at("primitives"))
    if (primitive.contains("targets")) count = std::max(count, primitive["targets"].size());
  return count;
}

template <class Work>
auto with_json_errors(const Scene& scene, Work work) {
  try {
    return work();
  } catch (const PlainJson::exception& error) {
    throw Error("'" + scene.path.string() + "': its morph targets are damaged: " + error.what());
  }
}

/// Adds what one morph target of a mesh moves.
void add_parts(const Accessors& accessors, size_t mesh, size_t target, Shape& shape) {
  const PlainJson& primitives = accessors.gltf().at("meshes").at(mesh).at("primitives");
  for (size_t p = 0; p < primitives.size(); ++p) {
    const auto targets = primitives[p].find("targets");
    if (targets == primitives[p].end() || target >= targets->size()) continue;
    const auto position = (*targets)[target].find("POSITION");
    if (position == (*targets)[target].end()) continue;
    ShapePart part{static_cast<int>(mesh), static_cast<int>(p), {}};
    const std::vector<float> flat = accessors.read(position->get<size_t>());
    for (size_t i = 0; i + 2 < flat.size(); i += 3)
      part.displacements.emplace_back(flat[i], flat[i + 1], flat[i + 2]);
    shape.parts.push_back(std::move(part));
  }
}

struct TargetPlace {
  std::string name;
  size_t mesh = 0, target = 0;
};

std::vector<TargetPlace> named_targets(const PlainJson& gltf,
                                       const std::function<bool(const std::string&)>& is_wanted) {
  std::vector<TargetPlace> places;
  const PlainJson meshes = gltf.value("meshes", PlainJson::array());
  for (size_t m = 0; m < meshes.size(); ++m)
    for (size_t t = 0; t < target_count(meshes[m]); ++t)
      if (std::string name = target_name(meshes[m], t); !is_wanted || is_wanted(name))
        places.push_back({std::move(name), m, t});
  return places;
}

std::vector<Shape> read_shapes(const Scene& scene, const std::function<bool(const std::string&)>& is_wanted) {
  const std::vector<TargetPlace> places = named_targets(PlainJson::parse(scene.document.json), is_wanted);
  if (places.empty()) return {};  // before the file's numbers are looked at
  const Accessors accessors(scene);
  std::vector<Shape> shapes;
  std::map<std::string, size_t> known;
  for (const TargetPlace& place : places) {
    const auto [at, is_new] = known.try_emplace(place.name, shapes.size());
    if (is_new) shapes.push_back({place.name, {}});
    add_parts(accessors, place.mesh, place.target, shapes[at->second]);
  }
  return shapes;
}

/// One animation channel of weights: `width` numbers a key.
struct WeightKeys {
  std::vector<float> times, values;
  std::string interpolation;
  size_t width = 0;
  std::vector<double> base;  ///< weights the base mesh was read with

  double key(size_t k, size_t weight, size_t part) const {
    const bool is_cubic = interpolation == "CUBICSPLINE";
    return static_cast<double>(values.at((is_cubic ? 3 * k + part : k) * width + weight));
  }

  /// glTF 2.0, appendix C.
  double at(double time, size_t weight) const {
    const size_t middle = interpolation == "CUBICSPLINE" ? 1 : 0;
    if (time <= times.front()) return key(0, weight, middle);
    if (time >= times.back()) return key(times.size() - 1, weight, middle);
    const size_t next =
        static_cast<size_t>(std::upper_bound(times.begin(), times.end(), time) - times.begin());
    const size_t k = next - 1;
    const double span = static_cast<double>(times[next]) - static_cast<double>(times[k]),
                 t = (time - static_cast<double>(times[k])) / span;
    const double a = key(k, weight, middle), b = key(next, weight, middle);
    if (interpolation == "STEP") return a;
    if (middle == 0) return a + t * (b - a);
    const double t2 = t * t, t3 = t2 * t;
    return (2 * t3 - 3 * t2 + 1) * a + span * (t3 - 2 * t2 + t) * key(k, weight, 2) + (-2 * t3 + 3 * t2) * b +
           span * (t3 - t2) * key(next, weight, 0);
  }
};

ShapeCurves read_curves(const Scene& scene) {
  const Accessors accessors(scene);
  const PlainJson& gltf = accessors.gltf();
  ShapeCurves curves;
  for (const PlainJson& animation : gltf.value("animations", PlainJson::array())) {
    std::vector<std::pair<size_t, WeightKeys>> channels;  // mesh
    std::set<double> times;
    for (const PlainJson& channel : animation.at("channels")) {
      const PlainJson& target = channel.at("target");
      if (target.value("path", "") != "weights" || !target.contains("node")) continue;
      const PlainJson& node = gltf.at("nodes").at(target["node"].get<size_t>());
      if (!node.contains("mesh")) continue;
      const auto mesh = node["mesh"].get<size_t>();
      const PlainJson& sampler = animation.at("samplers").at(channel.at("sampler").get<size_t>());
      WeightKeys keys;
      keys.times = accessors.read(sampler.at("input").get<size_t>());
      keys.values = accessors.read(sampler.at("output").get<size_t>());
      keys.interpolation = sampler.value("interpolation", "LINEAR");
      keys.width = target_count(gltf.at("meshes").at(mesh));
      if (keys.width == 0) continue;
      const PlainJson& holder = node.contains("weights") ? node : gltf.at("meshes").at(mesh);
      if (holder.contains("weights")) keys.base = holder["weights"].get<std::vector<double>>();
      keys.base.resize(keys.width, 0.0);
      const size_t parts = keys.interpolation == "CUBICSPLINE" ? 3 : 1;
      if (keys.times.empty() || keys.values.size() < keys.times.size() * keys.width * parts ||
          !std::is_sorted(keys.times.begin(), keys.times.end()))
        accessors.fail("its animation of morph weights has fewer values than its times and targets need");
      times.insert(keys.times.begin(), keys.times.end());
      channels.emplace_back(mesh, std::move(keys));
    }
    if (channels.empty()) continue;
    for (const auto& [mesh, keys] : channels)
      for (size_t t = 0; t < keys.width; ++t) {
        Shape& shape = curves.shapes.emplace_back(Shape{target_name(gltf.at("meshes").at(mesh), t), {}});
        add_parts(accessors, mesh, t, shape);
      }
    curves.times.assign(times.begin(), times.end());
    for (const double time : curves.times) {
      std::vector<double>& weights = curves.weights.emplace_back();
      for (const auto& [mesh, keys] : channels)
        for (size_t t = 0; t < keys.width; ++t)
          weights.push_back(keys.at(time, t) - keys.base[t]);
    }
    return curves;
  }
  return curves;
}

}  // namespace

std::vector<Shape> morph_shapes(const Scene& scene,
                                const std::function<bool(const std::string& name)>& is_wanted) {
  if (scene.document.json.empty()) return {};
  return with_json_errors(scene, [&] { return read_shapes(scene, is_wanted); });
}

ShapeCurves shape_curves(const Scene& scene) {
  if (scene.document.json.empty()) return {};
  return with_json_errors(scene, [&] { return read_curves(scene); });
}

}  // namespace fascia::formats
