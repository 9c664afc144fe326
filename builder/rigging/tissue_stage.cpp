#include <algorithm>
#include <initializer_list>
#include <set>

#include "builder/rigging/shared_vertices.h"
#include "builder/rigging/stages.h"
#include "builder/tissue/build.h"
#include "geometry/error.h"

namespace fascia::rigging {

namespace {

/// One part of one mesh, and which of the mesh's vertices it is made of.
struct MeshPart {
  size_t mesh = 0;
  prepare::Part part = prepare::Part::other;
  std::vector<uint32_t> vertices;
};

/// Every mesh taken apart by what its pieces are. Of a mesh that several nodes show only the first counts.
std::vector<MeshPart> take_apart(const formats::Scene& scene, const prepare::PreparedHead& head) {
  std::vector<MeshPart> all;
  std::set<std::pair<int, int>> seen;
  for (size_t m = 0; m < head.meshes.size(); ++m) {
    const formats::SceneMesh& source = scene.meshes[m];
    if (source.mesh >= 0 && !seen.insert({source.mesh, source.primitive}).second) continue;
    std::map<prepare::Part, MeshPart> parts;
    for (size_t v = 0; v < head.meshes[m].parts.size(); ++v) {
      MeshPart& part = parts[head.meshes[m].parts[v]];
      part.mesh = m;
      part.part = head.meshes[m].parts[v];
      part.vertices.push_back(static_cast<uint32_t>(v));
    }
    for (auto& [kind, part] : parts)
      all.push_back(std::move(part));
  }
  return all;
}

tissue::PartMesh part_mesh(const prepare::PreparedMesh& mesh, const MeshPart& part) {
  tissue::PartMesh out;
  out.part = prepare::part_name(part.part);
  std::vector<int> map(mesh.positions.size(), -1);
  for (uint32_t v : part.vertices) {
    map[v] = static_cast<int>(out.vertices.size());
    out.vertices.push_back(mesh.positions[v]);
    if (part.part == prepare::Part::skin) out.skin_vertices.push_back(mesh.skin_vertices[v]);
  }
  for (const Triangle& t : mesh.triangles) {
    const Triangle corners = {map[static_cast<size_t>(t[0])], map[static_cast<size_t>(t[1])],
                              map[static_cast<size_t>(t[2])]};
    if (corners[0] >= 0 && corners[1] >= 0 && corners[2] >= 0) out.triangles.push_back(corners);
  }
  return out;
}

/// Puts the bindings of a mesh's parts together again, vertex by vertex.
std::vector<rig::Binding> put_together(const formats::Scene& scene, const prepare::PreparedHead& head,
                                       const std::vector<MeshPart>& parts,
                                       const std::vector<rig::Binding>& bindings) {
  std::vector<rig::Binding> whole;
  for (size_t i = 0; i < parts.size(); ++i) {
    const bool goes_on = i > 0 && parts[i].mesh == parts[i - 1].mesh;
    const formats::SceneMesh& source = scene.meshes[parts[i].mesh];
    const size_t count = source.positions.size();
    if (!goes_on) {
      rig::Binding binding;
      binding.mesh = static_cast<uint32_t>(source.mesh >= 0 ? source.mesh : static_cast<int>(parts[i].mesh));
      binding.primitive = static_cast<uint32_t>(std::max(0, source.primitive));
      binding.part = bindings[i].part;
      binding.vertex_count = static_cast<uint32_t>(count);
      binding.influences = bindings[i].influences;
      binding.to_rig = (head.input_to_metres * source.to_file).cast<float>();
      binding.nodes.assign(count * binding.influences, 0);
      binding.weights.assign(count * binding.influences, 0.0F);
      binding.jaw_weights.assign(count, 0.0F);
      binding.eye.assign(count, 0);
      whole.push_back(std::move(binding));
    }
    rig::Binding& binding = whole.back();
    if (bindings[i].influences != binding.influences)
      throw Error("bindings of one mesh differ in their influences");
    if (parts[i].part == prepare::Part::skin) binding.part = "skin";
    for (size_t v = 0; v < parts[i].vertices.size(); ++v) {
      const size_t to = parts[i].vertices[v];
      for (size_t k = 0; k < binding.influences; ++k) {
        binding.nodes[to * binding.influences + k] = bindings[i].nodes[v * binding.influences + k];
        binding.weights[to * binding.influences + k] = bindings[i].weights[v * binding.influences + k];
      }
      binding.jaw_weights[to] = bindings[i].jaw_weights[v];
      binding.eye[to] = bindings[i].eye[v];
    }
  }
  return whole;
}

std::vector<tissue::LevelOptions> levels_up_to(const std::string& detail) {
  std::vector<tissue::LevelOptions> levels;
  for (const tissue::LevelOptions& level : tissue::TissueOptions{}.levels) {
    levels.push_back(level);
    if (level.name == detail) return levels;
  }
  throw Error("detail '" + detail + "' is unknown: use low, medium or high");
}

/// #channels: what members of a set play together; empty when one of them is not in it.
std::vector<float> played(const rig::Actuation& actuation, const std::string& set_name,
                          std::initializer_list<std::string> members) {
  const auto set = std::find_if(actuation.sets.begin(), actuation.sets.end(),
                                [&](const rig::NamedSet& one) { return one.name == set_name; });
  if (set == actuation.sets.end()) return {};
  std::vector<float> values(actuation.channels.size(), 0.0F);
  for (const std::string& member : members) {
    const auto at = std::find(set->members.begin(), set->members.end(), member);
    if (at == set->members.end()) return {};
    for (size_t i = 0; i < set->member_indices.size(); ++i)
      if (static_cast<std::ptrdiff_t>(set->member_indices[i]) == at - set->members.begin())
        values[set->channel_indices[i]] += set->weights[i];
  }
  return values;
}

}  // namespace

tissue::TissueInputs tissue_inputs(const formats::Scene& scene, const prepare::PreparedHead& head,
                                   const skull::FitResult& skull, const smas::Result& smas,
                                   const Landmarks& landmarks, const anatomy::Mechanics& mechanics,
                                   const rig::Rig& rig) {
  tissue::TissueInputs inputs;
  inputs.mechanics = mechanics;
  inputs.skin = head.skin;
  inputs.landmarks = landmarks;
  inputs.cranium = skull.cranium;
  inputs.mandible = skull.mandible;
  inputs.smas = smas.mesh;
  inputs.smas_bone_attachment = rig.smas.bone_attachment;
  inputs.jaw = rig.skull.jaw;
  inputs.eye_left = rig.skull.eye_left;
  inputs.eye_right = rig.skull.eye_right;
  inputs.ligaments = rig.smas.ligaments;
  inputs.muscles = rig.muscles;
  inputs.channels = rig.actuation.channels;
  inputs.blink = played(rig.actuation, "arkit", {"eyeBlinkLeft", "eyeBlinkRight"});
  for (const MeshPart& part : take_apart(scene, head))
    inputs.parts.push_back(part_mesh(head.meshes[part.mesh], part));
  return inputs;
}

rig::Tissue build_tissue(const formats::Scene& scene, const prepare::PreparedHead& head,
                         const tissue::TissueInputs& inputs, const BuildOptions& options,
                         BuildReport& report) {
  tissue::TissueOptions tissue_options;
  tissue_options.levels = levels_up_to(options.detail);
  tissue_options.for_each = options.for_each;
  tissue::TissueResult built = tissue::build(inputs, tissue_options);
  report.warnings.insert(report.warnings.end(), built.warnings.begin(), built.warnings.end());
  for (const auto& figures : built.figures) {
    report.tissue.push_back({figures.level, figures.nodes, figures.springs});
    if (figures.turned_prisms > 0)
      report.warnings.push_back("level " + figures.level + " has " + std::to_string(figures.turned_prisms) +
                                " inverted elements at rest; check the mesh at lips and lids");
  }
  const std::vector<MeshPart> parts = take_apart(scene, head);
  run_each(options.for_each, built.tissue.bindings.size(), [&](size_t level) {
    std::vector<rig::Binding>& bindings = built.tissue.bindings[level];
    bindings = put_together(scene, head, parts, bindings);
    share_vertices(scene, bindings);
  });
  return std::move(built.tissue);
}

}  // namespace fascia::rigging
