#include "gltf/edit/animation.h"

#include <algorithm>

#include "geometry/error.h"
#include "gltf/read/accessors.h"

namespace fascia::gltf {
namespace {

/// True when `channel` drives all weights of one of `nodes`, or of `mesh` itself.
bool drives(const Json& channel, uint32_t mesh, const std::vector<std::size_t>& nodes) {
  const Json target = channel.value("target", Json::object());
  if (target.value("path", "") == "weights" && target.contains("node"))
    return std::find(nodes.begin(), nodes.end(), target["node"].get<std::size_t>()) != nodes.end();
  const Json::json_pointer place("/extensions/KHR_animation_pointer/pointer");
  if (!target.contains(place)) return false;
  const auto pointer = target[place].get<std::string>();
  if (pointer == "/meshes/" + std::to_string(mesh) + "/weights") return true;
  return std::any_of(nodes.begin(), nodes.end(), [&](std::size_t node) {
    return pointer == "/nodes/" + std::to_string(node) + "/weights";
  });
}

/// Rows of `before` numbers as rows of `after`, the rest zero.
std::vector<float> widened(const std::vector<float>& values, std::size_t before, std::size_t after) {
  std::vector<float> result;
  result.reserve(values.size() / before * after);
  for (std::size_t row = 0; row < values.size() / before; ++row) {
    const auto begin = values.begin() + static_cast<std::ptrdiff_t>(row * before);
    result.insert(result.end(), begin, begin + static_cast<std::ptrdiff_t>(before));
    result.insert(result.end(), after - before, 0.0F);
  }
  return result;
}

void lengthen_channel(Edit& edit, const tinygltf::Model& model, Json& animation, Json& channel,
                      std::size_t before, std::size_t after) {
  Json sampler = animation.at("samplers").at(channel.at("sampler").get<std::size_t>());
  const std::size_t keys = accessor_view(model, sampler.at("input").get<int>(), "animation").count;
  const std::vector<float> values = decode_floats(model, sampler.at("output").get<int>(), "animation");
  const std::size_t rows = keys * (sampler.value("interpolation", "LINEAR") == "CUBICSPLINE" ? 3 : 1);
  if (before == 0 || values.size() != rows * before)
    throw Error("it has " + std::to_string(values.size()) + " weights where " +
                std::to_string(rows * before) + " are due");
  sampler["output"] = edit.add_floats(widened(values, before, after), 1, false);
  const auto shared =
      std::count_if(animation["channels"].begin(), animation["channels"].end(),
                    [&](const Json& other) { return other.at("sampler") == channel["sampler"]; });
  if (shared == 1) {
    animation["samplers"][channel["sampler"].get<std::size_t>()] = std::move(sampler);
    return;
  }
  animation["samplers"].push_back(std::move(sampler));
  channel["sampler"] = animation["samplers"].size() - 1;
}

}  // namespace

void lengthen_weights(Edit& edit, const tinygltf::Model& model, uint32_t mesh, std::size_t before,
                      std::size_t after, std::vector<std::string>& warnings) {
  const std::vector<std::size_t> nodes = edit.nodes_of(mesh);
  for (const std::size_t node : nodes) {
    if (!edit.json["nodes"][node].contains("weights")) continue;
    Json& weights = edit.json["nodes"][node]["weights"];
    while (weights.size() < after)
      weights.push_back(0.0);
  }
  if (!edit.json.contains("animations")) return;
  for (Json& animation : edit.json["animations"])
    for (Json& channel : animation.at("channels"))
      try {
        if (drives(channel, mesh, nodes)) lengthen_channel(edit, model, animation, channel, before, after);
      } catch (const Error& error) {
        warnings.push_back("clip '" + animation.value("name", "") + "' does not fit mesh " +
                           std::to_string(mesh) + " (" + error.what() + "); it is left as it came");
      }
}

std::vector<float> default_weights(const Json& root, const Json& node, std::size_t count) {
  std::vector<float> weights;
  if (node.contains("weights")) {
    weights = node["weights"].get<std::vector<float>>();
  } else if (node.contains("mesh")) {
    const Json& mesh = root.at("meshes").at(node["mesh"].get<std::size_t>());
    if (mesh.contains("weights")) weights = mesh["weights"].get<std::vector<float>>();
  }
  weights.resize(count, 0.0F);
  return weights;
}

}  // namespace fascia::gltf
