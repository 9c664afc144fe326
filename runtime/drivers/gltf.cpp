#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>

#include "geometry/error.h"
#include "gltf/read/accessors.h"
#include "gltf/read/container.h"
#include "gltf/read/model.h"
#include "rig/model/extensions.h"
#include "runtime/drivers/curves.h"

namespace fascia::runtime {
namespace {

using Json = nlohmann::json;

/// N of /extensions/FASCIA_actuation/channels/N/value; -1 of any other pointer.
int64_t pointed_channel(const std::string& pointer) {
  const std::string before = "/extensions/" + rig::actuation_extension + "/channels/", after = "/value";
  if (pointer.size() <= before.size() + after.size() || pointer.compare(0, before.size(), before) != 0 ||
      pointer.compare(pointer.size() - after.size(), after.size(), after) != 0)
    return -1;
  const char* begin = pointer.data() + before.size();
  const char* end = pointer.data() + pointer.size() - after.size();
  uint32_t index = 0;
  const auto parsed = std::from_chars(begin, end, index);
  return parsed.ec == std::errc() && parsed.ptr == end ? static_cast<int64_t>(index) : -1;
}

std::string channel_name(const Json& root, int64_t index) {
  const Json::json_pointer place("/extensions/" + rig::actuation_extension + "/channels");
  if (!root.contains(place)) return "#" + std::to_string(index);
  const Json& channels = root.at(place);
  if (!channels.is_array() || static_cast<std::size_t>(index) >= channels.size())
    throw Error("curves: an animation points at channel " + std::to_string(index) + ", which does not exist");
  return channels.at(static_cast<std::size_t>(index)).at("name").get<std::string>();
}

/// Every `width`th number of a sampler's output, from number `first` on, as a curve.
Curve sampled(const tinygltf::Model& model, const Json& sampler, const std::string& name,
              std::size_t width = 1, std::size_t first = 0) {
  const std::string path = "curves: animation of " + name;
  Curve curve;
  curve.name = name;
  const std::vector<float> times = gltf::decode_floats(model, sampler.at("input").get<int>(), path);
  const std::vector<float> values = gltf::decode_floats(model, sampler.at("output").get<int>(), path);
  curve.times.assign(times.begin(), times.end());
  const std::string kind = sampler.value("interpolation", "LINEAR");
  const std::size_t per_key = kind == "CUBICSPLINE" ? 3 : 1;
  if (times.empty() || values.size() != times.size() * per_key * width)
    throw Error(path + ": " + std::to_string(values.size()) + " values for " + std::to_string(times.size()) +
                " times");
  for (std::size_t i = 0; i < times.size(); ++i)
    if (!std::isfinite(times[i]) || (i > 0 && !(times[i] > times[i - 1])))
      throw Error(path + ": times must rise");
  for (const float value : values)
    if (!std::isfinite(value)) throw Error(path + ": a value is not finite");
  if (kind == "STEP") curve.interpolation = Interpolation::step;
  if (per_key == 3) curve.interpolation = Interpolation::cubic;
  for (std::size_t i = 0; i < times.size(); ++i) {
    const auto value = [&](std::size_t part) { return values[(per_key * i + part) * width + first]; };
    curve.values.push_back(value(per_key == 3 ? 1 : 0));
    if (per_key == 1) continue;
    curve.tangents_in.push_back(value(0));
    curve.tangents_out.push_back(value(2));
  }
  return curve;
}

std::string name_of(const Json& animation, std::size_t index) {
  return animation.value("name", "animation " + std::to_string(index));
}

/// The curves of one animation's morph weights, by the targets' names. Meshes of one avatar bear the same
/// names: the first that has one speaks for it.
void read_weights(const tinygltf::Model& model, const Json& root, const Json& animation, Curves& result) {
  const Json::json_pointer names_of("/extras/targetNames");
  for (const Json& channel : animation.at("channels")) {
    const Json& target = channel.at("target");
    if (target.value("path", "") != "weights" || !target.contains("node")) continue;
    const Json& node = root.at("nodes").at(target.at("node").get<std::size_t>());
    if (!node.contains("mesh")) continue;
    const Json& mesh = root.at("meshes").at(node.at("mesh").get<std::size_t>());
    if (!mesh.contains(names_of)) continue;
    const Json& names = mesh.at(names_of);
    const Json& sampler = animation.at("samplers").at(channel.at("sampler").get<std::size_t>());
    for (std::size_t t = 0; t < names.size(); ++t) {
      const std::string name = names.at(t).get<std::string>();
      const bool is_known = std::any_of(result.curves.begin(), result.curves.end(),
                                        [&](const Curve& curve) { return curve.name == name; });
      if (!is_known) result.curves.push_back(sampled(model, sampler, name, names.size(), t));
    }
  }
}

void read_pointers(const tinygltf::Model& model, const Json& root, const Json& animation, Curves& result) {
  const Json::json_pointer pointer("/target/extensions/KHR_animation_pointer/pointer");
  for (const Json& channel : animation.at("channels")) {
    if (!channel.contains(pointer)) continue;
    const int64_t index = pointed_channel(channel.at(pointer).get<std::string>());
    if (index < 0) continue;
    const Json& sampler = animation.at("samplers").at(channel.at("sampler").get<std::size_t>());
    result.curves.push_back(sampled(model, sampler, channel_name(root, index)));
  }
}

/// The curves of the first animation in which `read` finds any, and a note when others have some too.
template <class Read>
void read_first(const Json& root, Read read, Curves& result) {
  if (!root.contains("animations")) return;
  std::string first, others;
  for (std::size_t a = 0; a < root["animations"].size(); ++a) {
    const Json& animation = root["animations"][a];
    Curves found;
    read(animation, found);
    if (found.curves.empty()) continue;
    if (result.curves.empty()) {
      result.curves = std::move(found.curves);
      first = name_of(animation, a);
    } else {
      others += (others.empty() ? "" : ", ") + name_of(animation, a);
    }
  }
  if (!others.empty())
    result.notes.push_back("of several animations the first plays, " + first + "; not " + others);
}

}  // namespace

Curves read_gltf_curves(std::span<const uint8_t> bytes) {
  const tinygltf::Model model = gltf::load_model(bytes, "curves");
  Curves result;
  try {
    // tinygltf 2.7 drops pointer channels, so the animations are read from the JSON itself.
    const Json root = Json::parse(gltf::glb_chunks(bytes, "curves").json);
    read_first(
        root, [&](const Json& animation, Curves& found) { read_pointers(model, root, animation, found); },
        result);
    if (result.curves.empty())
      read_first(
          root, [&](const Json& animation, Curves& found) { read_weights(model, root, animation, found); },
          result);
  } catch (const Json::exception& error) {
    throw Error(std::string("curves: malformed glTF animation: ") + error.what());
  }
  if (result.curves.empty())
    throw Error(
        "curves: no animation in the glTF file points at a FASCIA_actuation channel or moves morph targets "
        "that "
        "have names (mesh.extras.targetNames)");
  return result;
}

}  // namespace fascia::runtime
