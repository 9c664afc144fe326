#include "gltf/edit/morph_targets.h"

#include <algorithm>
#include <set>

#include "geometry/error.h"
#include "gltf/edit/animation.h"
#include "gltf/edit/shading.h"
#include "gltf/read/model.h"

namespace fascia::gltf {
namespace {

/// Names of shapes that meshes have already, by what became of the new ones.
struct Heard {
  std::set<std::string> renamed, replaced;
  std::set<std::string> on;     ///< renamed, though to be replaced: the old ones are on by default
  std::set<std::string> still;  ///< not replaced everywhere: the new ones move nothing in some mesh

  void tell(std::vector<std::string>& warnings) const {
    for (const std::string& name : renamed)
      warnings.push_back(owned(name) + "the new one is called 'fascia_" + name + "'");
    for (const std::string& name : replaced)
      warnings.push_back(owned(name) + "it is replaced");
    for (const std::string& name : on)
      warnings.push_back(
          owned(name) +
          "it is on by default and so part of the face at rest, stays, and the new one is called 'fascia_" +
          name + "'");
    for (const std::string& name : still)
      warnings.push_back(owned(name) + "it stays in the meshes that the new one does not move");
  }

 private:
  static std::string owned(const std::string& name) {
    return "the head has a shape '" + name + "' of its own: ";
  }
};

/// One mesh of the file while targets are added to it.
class MeshMorphs {
 public:
  MeshMorphs(Edit& edit, const tinygltf::Model& model, uint32_t mesh)
      : edit_(edit), mesh_(mesh), path_("mesh " + std::to_string(mesh)), shading_(mesh_shading(model, mesh)) {
    Json& entry = json();
    for (Json& primitive : entry["primitives"])
      before_ = std::max(before_, primitive.contains("targets") ? primitive["targets"].size() : 0);
    names_ = target_names(entry, before_);
    rest_ = shading_.turned(still());
  }

  std::size_t count() const { return names_.size(); }
  std::size_t before() const { return before_; }

  /// Adds one shape; returns its index, or -1 when it moves nothing here.
  int add(const std::string& name, const std::vector<PrimitiveMotion>& shape, const MorphOptions& options,
          Heard& heard) {
    const std::vector<std::vector<Vec3f>> displacements = gathered(shape);
    const bool moves =
        std::any_of(displacements.begin(), displacements.end(), [](const std::vector<Vec3f>& motion) {
          return std::any_of(motion.begin(), motion.end(), [](const Vec3f& d) { return !d.isZero(0); });
        });
    const std::vector<std::size_t> known = own_targets(name);
    const bool replaces = options.existing == MorphOptions::Existing::replace;
    if (!moves) {
      if (replaces && !known.empty()) heard.still.insert(name);
      return -1;
    }
    // The rest that is seen is made with a target that is on by default: it must stay what it is.
    const bool is_on =
        std::any_of(known.begin(), known.end(), [&](std::size_t t) { return is_on_by_default(t); });
    if (!known.empty()) (!replaces ? heard.renamed : is_on ? heard.on : heard.replaced).insert(name);
    if (known.empty() || !replaces || is_on) {
      names_.push_back(known.empty() ? name : free_name(name));
      put(names_.size() - 1, displacements, turned(displacements, options));
      return static_cast<int>(names_.size() - 1);
    }
    const MeshShading::Turned turns = turned(displacements, options);
    for (const std::size_t target : known)
      clear(target);
    for (const std::size_t target : known)
      put(target, displacements, turns);
    return static_cast<int>(known.front());
  }

  /// Names, default weights and normals, once all shapes are in.
  void finish() {
    Json& entry = json();
    if (!entry.contains("extras") || !entry["extras"].is_object()) {
      const Json kept = entry.value("extras", Json());
      entry["extras"] = Json::object();
      if (!kept.is_null()) entry["extras"]["extras"] = kept;
    }
    entry["extras"]["targetNames"] = names_;
    if (!entry.contains("weights")) entry["weights"] = Json::array();
    while (entry["weights"].size() < names_.size())
      entry["weights"].push_back(0.0);
    for (std::size_t p = 0; p < shading_.primitives().size(); ++p)
      add_normals(p);
  }

 private:
  static std::vector<std::string> target_names(const Json& entry, std::size_t count) {
    std::vector<std::string> names;
    const Json::json_pointer place("/extras/targetNames");
    if (entry.contains("extras") && entry["extras"].is_object() && entry.contains(place) &&
        entry[place].is_array())
      for (const Json& name : entry[place])
        names.push_back(name.is_string() ? name.get<std::string>()
                                         : "target_" + std::to_string(names.size()));
    names.resize(std::min(names.size(), count));
    while (names.size() < count)
      names.push_back("target_" + std::to_string(names.size()));
    return names;
  }

  /// The targets of that name that the mesh had before.
  std::vector<std::size_t> own_targets(const std::string& name) const {
    std::vector<std::size_t> targets;
    for (std::size_t t = 0; t < before_; ++t)
      if (names_[t] == name) targets.push_back(t);
    return targets;
  }

  bool is_on_by_default(std::size_t target) const {
    const std::vector<std::size_t> nodes = edit_.nodes_of(mesh_);
    return std::any_of(nodes.begin(), nodes.end(), [&](std::size_t node) {
      return default_weights(edit_.json, edit_.json["nodes"][node], before_)[target] != 0.0F;
    });
  }

  std::string free_name(const std::string& name) const {
    std::string candidate = "fascia_" + name;
    while (std::find(names_.begin(), names_.end(), candidate) != names_.end())
      candidate += "_";
    return candidate;
  }

  Json& json() { return edit_.json["meshes"][mesh_]; }
  std::vector<std::vector<Vec3f>> still() const {
    return {shading_.primitives().size(), std::vector<Vec3f>()};
  }

  std::vector<std::vector<Vec3f>> gathered(const std::vector<PrimitiveMotion>& shape) const {
    std::vector<std::vector<Vec3f>> displacements = still();
    for (const PrimitiveMotion& motion : shape) {
      if (motion.mesh != mesh_) continue;
      if (motion.primitive >= displacements.size() ||
          motion.displacement.size() != shading_.primitives()[motion.primitive].positions.size())
        throw Error(path_ + " primitive " + std::to_string(motion.primitive) +
                    ": the motion has another number of vertices: build the rig again");
      displacements[motion.primitive] = motion.displacement;
    }
    return displacements;
  }

  /// By how much normals and tangents turn for a shape at weight 1.
  MeshShading::Turned turned(const std::vector<std::vector<Vec3f>>& displacements,
                             const MorphOptions& options) const {
    MeshShading::Turned there = shading_.turned(displacements);
    if (!options.is_linear) return minus(there, rest_, 1.0F);
    std::vector<std::vector<Vec3f>> back = displacements;
    for (std::vector<Vec3f>& motion : back)
      for (Vec3f& d : motion)
        d = -d;
    return minus(there, shading_.turned(back), 0.5F);
  }

  static MeshShading::Turned minus(MeshShading::Turned a, const MeshShading::Turned& b, float scale) {
    for (auto [to, from] : {std::pair(&a.normals, &b.normals), std::pair(&a.tangents, &b.tangents)})
      for (std::size_t p = 0; p < to->size(); ++p)
        for (std::size_t v = 0; v < (*to)[p].size(); ++v)
          (*to)[p][v] = scale * ((*to)[p][v] - (*from)[p][v]);
    return a;
  }

  /// Takes a target's data out of the file; its number stays.
  void clear(std::size_t index) {
    std::set<std::size_t> accessors;
    for (Json& primitive : json()["primitives"]) {
      if (!primitive.contains("targets") || index >= primitive["targets"].size()) continue;
      for (const Json& accessor : primitive["targets"][index])
        accessors.insert(accessor.get<std::size_t>());
      primitive["targets"][index] = Json::object();
    }
    for (const std::size_t accessor : accessors)
      edit_.data().give_back(accessor);
  }

  void put(std::size_t index, const std::vector<std::vector<Vec3f>>& displacements,
           const MeshShading::Turned& turned) {
    for (std::size_t p = 0; p < shading_.primitives().size(); ++p) {
      const ShadedPrimitive& rest = shading_.primitives()[p];
      std::vector<Vec3f> motion = displacements[p];
      motion.resize(rest.positions.size(), Vec3f::Zero());
      Json target = {{"POSITION", edit_.data().add_vectors(motion, true)}};
      if (!rest.triangles.empty() || rest.has_normals)
        target["NORMAL"] = edit_.data().add_vectors(turned.normals[p], false);
      if (!rest.tangents.empty()) target["TANGENT"] = edit_.data().add_vectors(turned.tangents[p], false);
      Json& primitive = edit_.primitive(mesh_, static_cast<uint32_t>(p));
      if (!primitive.contains("targets")) primitive["targets"] = Json::array();
      if (index < primitive["targets"].size())
        primitive["targets"][index] = std::move(target);
      else
        primitive["targets"].push_back(std::move(target));
    }
  }

  void add_normals(std::size_t p) {
    const ShadedPrimitive& rest = shading_.primitives()[p];
    if (rest.has_normals || rest.triangles.empty()) return;
    const std::span<const float> flat(reinterpret_cast<const float*>(rest.normals.data()),
                                      3 * rest.normals.size());
    const std::size_t normals = edit_.add_floats(flat, 3, false, vertex_target);
    edit_.primitive(mesh_, static_cast<uint32_t>(p))["attributes"]["NORMAL"] = normals;
  }

  Edit& edit_;
  uint32_t mesh_;
  std::string path_;
  MeshShading shading_;
  MeshShading::Turned rest_;
  std::size_t before_ = 0;
  std::vector<std::string> names_;
};

}  // namespace

std::vector<MeshTargets> add_morph_targets(Edit& edit, const std::vector<std::string>& names,
                                           const std::vector<std::vector<PrimitiveMotion>>& shapes,
                                           const MorphOptions& options, std::vector<std::string>* warnings) {
  std::set<uint32_t> meshes;
  for (const auto& shape : shapes)
    for (const PrimitiveMotion& motion : shape)
      meshes.insert(motion.mesh);
  return add_morph_targets(
      edit, meshes, names, [&](std::size_t s) { return shapes[s]; }, options, warnings);
}

std::vector<MeshTargets> add_morph_targets(
    Edit& edit, const std::set<uint32_t>& meshes, const std::vector<std::string>& names,
    const std::function<std::vector<PrimitiveMotion>(std::size_t)>& shape, const MorphOptions& options,
    std::vector<std::string>* warnings) {
  const tinygltf::Model& model = edit.model();
  std::vector<MeshTargets> result;
  std::vector<std::string> heard;
  Heard existing;
  for (const uint32_t mesh : meshes) {
    MeshMorphs morphs(edit, model, mesh);
    MeshTargets targets{mesh, 0, {}};
    for (std::size_t s = 0; s < names.size(); ++s)
      targets.targets.push_back(morphs.add(names[s], shape(s), options, existing));
    targets.count = morphs.count();
    if (std::all_of(targets.targets.begin(), targets.targets.end(), [](int target) { return target < 0; }))
      continue;
    morphs.finish();
    lengthen_weights(edit, model, mesh, morphs.before(), morphs.count(), heard);
    result.push_back(std::move(targets));
  }
  existing.tell(heard);
  if (warnings != nullptr) warnings->insert(warnings->end(), heard.begin(), heard.end());
  return result;
}

void add_weight_channels(Edit& edit, const std::vector<MeshTargets>& meshes, std::size_t keys,
                         const std::function<float(std::size_t shape, std::size_t key)>& weight,
                         std::size_t time, Json& animation) {
  for (const MeshTargets& mesh : meshes)
    for (const std::size_t node : edit.nodes_of(mesh.mesh)) {
      const std::vector<float> still = default_weights(edit.json, edit.json["nodes"][node], mesh.count);
      std::vector<float> values;
      values.reserve(keys * mesh.count);
      for (std::size_t f = 0; f < keys; ++f) {
        values.insert(values.end(), still.begin(), still.end());
        for (std::size_t s = 0; s < mesh.targets.size(); ++s)
          if (mesh.targets[s] >= 0)
            values[f * mesh.count + static_cast<std::size_t>(mesh.targets[s])] = weight(s, f);
      }
      animation["samplers"].push_back(
          {{"input", time}, {"output", edit.add_floats(values, 1, false)}, {"interpolation", "LINEAR"}});
      animation["channels"].push_back(
          {{"sampler", animation["samplers"].size() - 1}, {"target", {{"node", node}, {"path", "weights"}}}});
    }
}

}  // namespace fascia::gltf
