#include "gltf/edit/instances.h"

#include <set>

namespace fascia::gltf {

std::size_t separate_instances(Json& root) {
  if (!root.contains("nodes") || !root.contains("meshes")) return 0;
  std::set<std::size_t> shown;
  std::size_t added = 0;
  for (Json& node : root["nodes"]) {
    if (!node.contains("mesh") || !node["mesh"].is_number_unsigned()) continue;
    const auto mesh = node["mesh"].get<std::size_t>();
    if (mesh >= root["meshes"].size() || shown.insert(mesh).second) continue;
    Json copy = root["meshes"][mesh];
    node["mesh"] = root["meshes"].size();
    root["meshes"].push_back(std::move(copy));
    ++added;
  }
  return added;
}

}  // namespace fascia::gltf
