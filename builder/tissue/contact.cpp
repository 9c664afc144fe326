#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "builder/tissue/actuators.h"
#include "builder/tissue/bone_field.h"
#include "builder/tissue/fissure.h"

namespace fascia::tissue {
namespace {

constexpr double field_step = 1.5e-4;  // metres a unit: values reach 19 mm either way

/// Adds the distance field of `bone` over the box of `near`.
void add_field(const TriangleMesh& bone, uint8_t which, const Bounds& near, double spacing,
               rig::TissueLevel& level) {
  const BoneField field = sample_bone_field(bone, near, spacing, 130.0 * field_step);
  level.contact_field_bone.push_back(which);
  level.contact_field_origin.push_back(field.origin.cast<float>());
  level.contact_field_spacing.push_back(static_cast<float>(spacing));
  level.contact_field_step.push_back(static_cast<float>(field_step));
  level.contact_field_size.push_back(field.size);
  for (const float distance : field.distance)
    level.contact_field_values.push_back(
        static_cast<uint8_t>(std::clamp(std::round(128.0 + distance / field_step), 0.0, 255.0)));
}

}  // namespace

void add_contact(const TissueInputs& inputs, const Columns& c, rig::TissueLevel& level) {
  constexpr double field_spacing = 0.0025;  // metres
  const anatomy::Mechanics& m = inputs.mechanics;
  const auto n = static_cast<size_t>(c.count());
  const auto& mouth = c.opening_distance[static_cast<size_t>(Opening::mouth)];
  // What may meet bone and teeth: lips' and cheeks' inside with both jaws, the fascia with the bone it glides
  // on.
  std::array<std::vector<uint32_t>, 2> nodes;
  for (size_t v = 0; v < n; ++v) {
    if (c.rim[v]) continue;
    const bool lining = !c.outer[v] && mouth[v] < m.lips.lining_reach;
    for (uint32_t bone = 0; bone < 2; ++bone) {
      if (lining) nodes[bone].push_back(static_cast<uint32_t>(v));
      if (c.outer[v] && !c.bone[v]) nodes[bone].push_back(static_cast<uint32_t>(2 * n + v));
      if (c.outer[v] && mouth[v] < m.contact.lip_reach) nodes[bone].push_back(static_cast<uint32_t>(v));
    }
    if (c.outer[v] && c.bone[v]) nodes[c.jaw_weight[v] > 0.5 ? 1 : 0].push_back(static_cast<uint32_t>(n + v));
  }
  const Bones bones = bones_of(inputs);
  for (uint8_t bone = 0; bone < 2; ++bone) {
    if (nodes[bone].empty()) continue;
    Bounds box;
    for (const uint32_t node : nodes[bone]) {
      const Vec3 p = level.rest[node].cast<double>();
      box.lower = box.lower.cwiseMin(p);
      box.upper = box.upper.cwiseMax(p);
    }
    const auto field = static_cast<uint32_t>(level.contact_field_bone.size());
    add_field(bone == 0 ? bones.cranium : bones.mandible, bone, box, field_spacing, level);
    for (const uint32_t node : nodes[bone]) {
      level.contact_node.push_back(node);
      level.contact_field.push_back(field);
    }
  }
}

namespace {

void face(rig::TissueLevel& level, size_t triangle, uint8_t side) {
  level.facing_prism.push_back(static_cast<uint32_t>(triangle));
  level.facing_side.push_back(side);
}

/// The columns on either side of where skin turns into lining.
std::vector<bool> edge_columns(const Columns& c) {
  std::vector<bool> edge(static_cast<size_t>(c.count()));
  for (const fascia::Triangle& t : c.mesh.triangles)
    for (const int a : t)
      for (const int b : t)
        if (c.outer[static_cast<size_t>(a)] != c.outer[static_cast<size_t>(b)])
          edge[static_cast<size_t>(a)] = true;
  return edge;
}

/// The lids' edges, with the triangles around them.
void add_lid_facing(const TissueInputs& inputs, const FaceRegion& region, const Columns& c, bool left,
                    rig::TissueLevel& level) {
  const Fissure fissure(inputs, region, left);
  const auto& opening =
      c.opening_distance[static_cast<size_t>(left ? Opening::eye_left : Opening::eye_right)];
  const std::vector<bool> edge = edge_columns(c);
  for (size_t t = 0; t < c.mesh.triangles.size(); ++t) {
    int upper = 0;
    bool is_edge = false, is_near = true;
    for (const int i : c.mesh.triangles[t]) {
      const auto v = static_cast<size_t>(i);
      const double place = fissure.place(c.mesh.vertices[v]);
      is_edge = is_edge || edge[v];
      is_near = is_near && opening[v] < inputs.mechanics.contact.lid_reach && place > 0.0 && place < 1.0;
      upper += fissure.is_upper(c.mesh.vertices[v]) ? 1 : 0;
    }
    if (!is_edge || !is_near || (upper != 0 && upper != 3)) continue;  // at the canthi both lids are one
    face(level, t, static_cast<uint8_t>((left ? 2 : 4) + (upper == 3 ? 0 : 1)));
  }
}

}  // namespace

void add_facing(const TissueInputs& inputs, const FaceRegion& region, const Columns& c,
                rig::TissueLevel& level) {
  constexpr double corner_share = 0.06;  // of the way from lip to lip, by Columns::lower_lip
  for (size_t t = 0; t < c.mesh.triangles.size(); ++t) {
    double lower = 0.0, distance = 0.0;
    for (const int i : c.mesh.triangles[t]) {
      const auto v = static_cast<size_t>(i);
      lower += c.lower_lip[v] / 3.0;
      distance = std::max(distance, c.opening_distance[static_cast<size_t>(Opening::mouth)][v]);
    }
    // At the corner both lips are one.
    if (distance > inputs.mechanics.contact.lip_reach || std::abs(lower - 0.5) < corner_share) continue;
    face(level, t, lower < 0.5 ? 0 : 1);
  }
  for (const bool left : {true, false})
    add_lid_facing(inputs, region, c, left, level);
}

}  // namespace fascia::tissue
