#include "builder/rigging/shared_vertices.h"

#include <algorithm>

namespace fascia::rigging {

namespace {

/// The mesh of the scene that a binding moves; null where none does.
const formats::SceneMesh* source_of(const formats::Scene& scene, const rig::Binding& binding) {
  const auto found =
      std::find_if(scene.meshes.begin(), scene.meshes.end(), [&](const formats::SceneMesh& mesh) {
        return mesh.mesh == static_cast<int>(binding.mesh) &&
               mesh.primitive == static_cast<int>(binding.primitive);
      });
  return found == scene.meshes.end() ? nullptr : &*found;
}

/// Copies what vertex `v` follows.
void copy_vertex(const rig::Binding& from, rig::Binding& to, size_t v) {
  const auto begin = static_cast<std::ptrdiff_t>(v * from.influences), end = begin + from.influences;
  std::copy(from.nodes.begin() + begin, from.nodes.begin() + end, to.nodes.begin() + begin);
  std::copy(from.weights.begin() + begin, from.weights.begin() + end, to.weights.begin() + begin);
  to.jaw_weights[v] = from.jaw_weights[v];
  to.eye[v] = from.eye[v];
}

/// What the vertices of the group follow, all primitives taken together.
rig::Binding merged(const std::vector<rig::Binding*>& group,
                    const std::vector<const formats::SceneMesh*>& sources) {
  rig::Binding all = *group[0];
  std::fill(all.nodes.begin(), all.nodes.end(), 0);
  std::fill(all.weights.begin(), all.weights.end(), 0.0F);
  std::fill(all.jaw_weights.begin(), all.jaw_weights.end(), 0.0F);
  std::fill(all.eye.begin(), all.eye.end(), 0);
  std::vector<bool> is_drawn(all.jaw_weights.size(), false);
  for (size_t i = 0; i < group.size(); ++i)
    for (const Triangle& t : sources[i]->triangles)
      for (const int corner : t) {
        const auto v = static_cast<size_t>(corner);
        if (!is_drawn[v]) copy_vertex(*group[i], all, v);
        is_drawn[v] = true;
      }
  return all;
}

}  // namespace

void share_vertices(const formats::Scene& scene, std::vector<rig::Binding>& bindings) {
  std::vector<bool> is_done(bindings.size(), false);
  for (size_t first = 0; first < bindings.size(); ++first) {
    const formats::SceneMesh* source = source_of(scene, bindings[first]);
    if (is_done[first] || source == nullptr) continue;
    std::vector<rig::Binding*> group = {&bindings[first]};
    std::vector<const formats::SceneMesh*> sources = {source};
    for (size_t other = first + 1; other < bindings.size(); ++other) {
      const formats::SceneMesh* mesh = source_of(scene, bindings[other]);
      if (is_done[other] || mesh == nullptr || mesh->mesh != source->mesh ||
          bindings[other].influences != bindings[first].influences || mesh->positions != source->positions)
        continue;
      group.push_back(&bindings[other]);
      sources.push_back(mesh);
      is_done[other] = true;
    }
    if (group.size() == 1) continue;
    const rig::Binding all = merged(group, sources);
    for (rig::Binding* binding : group) {
      binding->nodes = all.nodes;
      binding->weights = all.weights;
      binding->jaw_weights = all.jaw_weights;
      binding->eye = all.eye;
    }
  }
}

}  // namespace fascia::rigging
