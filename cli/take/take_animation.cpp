#include "cli/take/take_animation.h"

#include <algorithm>

#include "cli/take/keyframes.h"

namespace fascia::cli {

namespace {

using Json = nlohmann::ordered_json;

/// Adds samplers and channels to one animation; keys at the same frames share their times.
class Animation {
 public:
  Animation(GltfEdit& edit, const Take& take, std::string name)
      : edit_(edit),
        take_(take),
        json_({{"name", std::move(name)}, {"samplers", Json::array()}, {"channels", Json::array()}}) {}

  void add(const std::vector<size_t>& keys, const std::vector<float>& values, const Json& target,
           int width = 1) {
    json_["samplers"].push_back({{"input", times(keys)},
                                 {"output", edit_.add_floats(values, width, false)},
                                 {"interpolation", "LINEAR"}});
    json_["channels"].push_back({{"sampler", json_["samplers"].size() - 1}, {"target", target}});
  }

  void finish() {
    if (!json_["channels"].empty()) edit_.json["animations"].push_back(json_);
  }

  Json& json() { return json_; }

  /// The accessor of the keys' times.
  size_t times(const std::vector<size_t>& keys) {
    const auto [entry, is_new] = times_.try_emplace(keys, 0);
    if (is_new) {
      std::vector<float> seconds;
      for (const size_t key : keys)
        seconds.push_back(static_cast<float>(take_.time(key)));
      entry->second = edit_.add_floats(seconds, 1, true);
    }
    return entry->second;
  }

 private:
  GltfEdit& edit_;
  const Take& take_;
  Json json_;
  std::map<std::vector<size_t>, size_t> times_;
};

/// Component `k` as displacements of the mesh's primitives.
std::vector<PrimitiveMotion> shape_of(const MeshMotion& motion, const Face& face, size_t k) {
  std::vector<PrimitiveMotion> shape;
  for (const size_t part : motion.mesh.parts)
    shape.push_back({face.meshes()[part].mesh, face.meshes()[part].primitive,
                     std::vector<rig::Vec3f>(face.meshes()[part].vertex_count, rig::Vec3f::Zero())});
  for (size_t i = 0; i < motion.vertices.size(); ++i) {
    const size_t vertex = motion.vertices[i];
    const auto after = std::upper_bound(motion.mesh.firsts.begin(), motion.mesh.firsts.end(), vertex);
    const auto part = static_cast<size_t>(after - motion.mesh.firsts.begin()) - 1;
    shape[part].displacement[vertex - motion.mesh.firsts[part]] =
        motion.shapes[k].segment<3>(static_cast<Eigen::Index>(3 * i));
  }
  return shape;
}

void add_pointers(GltfEdit& edit, const Recording& recording, const Face& face, Animation& animation) {
  bool any = false;
  fascia_channels channels = {};
  channels.struct_size = sizeof channels;
  check(fascia_asset_get_channels(face.asset(), &channels), "channels");
  for (Eigen::Index c = 0; c < recording.values.rows(); ++c) {
    const Eigen::MatrixXf row = recording.values.row(c);
    const float rest = channels.rest[c];
    if ((row.array() == row(0, 0)).all() && std::abs(row(0, 0) - rest) < 1e-6F) continue;
    any = true;
    const float tolerance = 1e-4F * (row.maxCoeff() - row.minCoeff());
    const std::vector<size_t> keys = keys_of(row, {&tolerance, 1});
    std::vector<float> values;
    for (const size_t key : keys)
      values.push_back(row(0, static_cast<Eigen::Index>(key)));
    const std::string pointer = "/extensions/FASCIA_actuation/channels/" + std::to_string(c) + "/value";
    animation.add(keys, values,
                  {{"path", "pointer"}, {"extensions", {{"KHR_animation_pointer", {{"pointer", pointer}}}}}});
  }
  if (!any) return;
  Json& used = edit.json["extensionsUsed"];
  if (std::find(used.begin(), used.end(), "KHR_animation_pointer") == used.end())
    used.push_back("KHR_animation_pointer");
}

}  // namespace

void add_take(GltfEdit& edit, const std::string& name, const Take& take, const Face& face,
              Recording recording, const std::vector<NodeMotion>& nodes, std::vector<std::string>& warnings) {
  Animation animation(edit, take, name);
  size_t expected = 0;
  for (const MeshMotion& motion : recording.meshes)
    expected += motion.shapes.size() * (24 * motion.mesh.vertices + 4 * motion.keys.size());
  edit.expect(expected);
  for (MeshMotion& recorded : recording.meshes) {
    MeshMotion motion = std::move(recorded);  // its memory is free again when it is in the file
    std::vector<std::string> names;
    for (size_t k = 0; k < motion.shapes.size(); ++k)
      names.push_back("motion_" + std::to_string(k));
    if (names.empty()) continue;
    gltf::MorphOptions options;
    options.is_linear = true;
    const std::vector<gltf::MeshTargets> targets = gltf::add_morph_targets(
        edit, {motion.mesh.mesh}, names, [&](size_t k) { return shape_of(motion, face, k); }, options,
        &warnings);
    motion.shapes = {};
    const auto weight = [&](size_t k, size_t key) {
      return motion.weights(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(key));
    };
    gltf::add_weight_channels(edit, targets, motion.keys.size(), weight, animation.times(motion.keys),
                              animation.json());
  }
  add_pointers(edit, recording, face, animation);
  for (const NodeMotion& motion : nodes) {
    animation.add(motion.keys, motion.rotations, {{"node", motion.node}, {"path", "rotation"}}, 4);
    if (!motion.translations.empty())
      animation.add(motion.keys, motion.translations, {{"node", motion.node}, {"path", "translation"}}, 3);
  }
  animation.finish();
}

}  // namespace fascia::cli
