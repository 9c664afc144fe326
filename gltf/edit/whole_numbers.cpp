#include "gltf/edit/whole_numbers.h"

#include <cmath>
#include <cstdint>
#include <limits>
#include <string_view>

#include "geometry/error.h"

namespace fascia::gltf {
namespace {

constexpr double largest_index = std::numeric_limits<int32_t>::max();
constexpr double largest_size = 9007199254740992.0;  // 2^53: what JSON holds exactly

/// Where whole numbers stand; a star is every element of an array, or every member of an object.
constexpr std::string_view indices[] = {"scene",
                                        "scenes/*/nodes/*",
                                        "nodes/*/mesh",
                                        "nodes/*/skin",
                                        "nodes/*/children/*",
                                        "meshes/*/primitives/*/indices",
                                        "meshes/*/primitives/*/material",
                                        "meshes/*/primitives/*/mode",
                                        "meshes/*/primitives/*/attributes/*",
                                        "meshes/*/primitives/*/targets/*/*",
                                        "accessors/*/bufferView",
                                        "accessors/*/componentType",
                                        "accessors/*/sparse/indices/bufferView",
                                        "accessors/*/sparse/indices/componentType",
                                        "accessors/*/sparse/values/bufferView",
                                        "bufferViews/*/buffer",
                                        "bufferViews/*/byteStride",
                                        "skins/*/inverseBindMatrices",
                                        "skins/*/joints/*",
                                        "animations/*/channels/*/sampler",
                                        "animations/*/channels/*/target/node",
                                        "animations/*/samplers/*/input",
                                        "animations/*/samplers/*/output",
                                        "textures/*/source",
                                        "images/*/bufferView"};
constexpr std::string_view sizes[] = {"accessors/*/byteOffset",
                                      "accessors/*/count",
                                      "accessors/*/sparse/count",
                                      "accessors/*/sparse/indices/byteOffset",
                                      "accessors/*/sparse/values/byteOffset",
                                      "bufferViews/*/byteOffset",
                                      "bufferViews/*/byteLength",
                                      "buffers/*/byteLength"};

bool make_whole(Json& number, double largest, const std::string& where) {
  if (!number.is_number()) return false;  // another fault, which the readers name
  const auto value = number.get<double>();
  if (!(value >= 0.0 && value <= largest) || value != std::floor(value))
    throw Error(where + " is " + number.dump() + ", not a whole number from 0 to " +
                std::to_string(static_cast<int64_t>(largest)) + "; export the file again");
  if (number.is_number_integer()) return false;
  number = static_cast<uint64_t>(value);
  return true;
}

/// Goes down `path` from `node`, which stands at `where`.
bool descend(Json& node, std::string_view path, double largest, const std::string& where) {
  if (path.empty()) return make_whole(node, largest, where);
  const std::size_t slash = path.find('/');
  const std::string_view step = path.substr(0, slash),
                         rest = slash == path.npos ? std::string_view() : path.substr(slash + 1);
  const std::string before = where.empty() ? "" : where + "/";
  bool any = false;
  if (step != "*") {
    if (!node.is_object()) return false;
    const auto at = node.find(std::string(step));
    return at != node.end() && descend(*at, rest, largest, before + std::string(step));
  }
  if (node.is_object())
    for (auto& [key, child] : node.items())
      any |= descend(child, rest, largest, before + key);
  if (node.is_array())
    for (std::size_t i = 0; i < node.size(); ++i)
      any |= descend(node[i], rest, largest, before + std::to_string(i));
  return any;
}

}  // namespace

bool make_whole_numbers(Json& root) {
  bool any = false;
  for (const std::string_view path : indices)
    any |= descend(root, path, largest_index, "");
  for (const std::string_view path : sizes)
    any |= descend(root, path, largest_size, "");
  return any;
}

}  // namespace fascia::gltf
