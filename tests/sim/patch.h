#pragma once

#include <cmath>
#include <limits>
#include <set>

#include "rig/model/rig.h"

namespace fascia::testing {

/// How a test's patch of tissue is made: a rectangular sheet of `across` x `along` cells of equilateral-ish
/// triangles in the plane z = 0, three layers deep towards -z, and what stiffness it has.
struct PatchOptions {
  uint32_t across = 8, along = 8;
  double cell = 0.005;
  double skin_depth = 0.003, inner_depth = 0.005;  ///< of SMAS and inner layer below the one above
  float membrane = 20.0F, bending = 1e-4F, volume = 2e4F;
  float retinacula = 10.0F;
  float tether_normal = 0.2F, tether_tangential = 0.4F;
  bool clamp_rim = true;
};

inline uint32_t column_at(const PatchOptions& o, uint32_t i, uint32_t j) {
  return j * (o.across + 1) + i;
}

/// A flat patch, slightly domed so that nothing is degenerate: inner nodes on the cranium, the rim fixed.
inline rig::TissueLevel make_patch(const PatchOptions& o) {
  rig::TissueLevel level;
  const uint32_t columns = (o.across + 1) * (o.along + 1);
  level.name = "patch";
  level.columns = columns;
  level.rest.resize(3 * columns);
  level.kinds.assign(3 * columns, rig::NodeKind::free);
  level.masses.assign(3 * columns, 5e-5F);
  level.jaw_weights.assign(3 * columns, 0.0F);
  for (uint32_t j = 0; j <= o.along; ++j)
    for (uint32_t i = 0; i <= o.across; ++i) {
      const uint32_t c = column_at(o, i, j);
      const double x = (i - 0.5 * o.across) * o.cell, y = (j - 0.5 * o.along) * o.cell;
      const double dome = -4.0 * (x * x + y * y);
      const bool rim = i == 0 || j == 0 || i == o.across || j == o.along;
      level.rest[c] = Eigen::Vector3d(x, y, dome).cast<float>();
      level.rest[columns + c] = Eigen::Vector3d(x, y, dome - o.skin_depth).cast<float>();
      level.rest[2 * columns + c] = Eigen::Vector3d(x, y, dome - o.skin_depth - o.inner_depth).cast<float>();
      level.kinds[2 * columns + c] = rig::NodeKind::fixed_cranium;
      if (rim && o.clamp_rim)
        for (uint32_t layer = 0; layer < 3; ++layer)
          level.kinds[layer * columns + c] = rig::NodeKind::fixed;
    }
  for (uint32_t j = 0; j < o.along; ++j)
    for (uint32_t i = 0; i < o.across; ++i) {
      const uint32_t a = column_at(o, i, j), b = column_at(o, i + 1, j), c = column_at(o, i + 1, j + 1),
                     d = column_at(o, i, j + 1);
      // Diagonals mirror about the middle, so that a mirrored load finds a mirrored mesh.
      if (2 * i < o.across) {
        level.triangles.push_back({a, b, c});
        level.triangles.push_back({a, c, d});
      } else {
        level.triangles.push_back({a, b, d});
        level.triangles.push_back({b, c, d});
      }
    }
  const size_t prisms = level.triangles.size();
  level.skin_membrane.assign(prisms, o.membrane);
  level.smas_membrane.assign(prisms, o.membrane);
  level.volume_stiffness.assign(prisms, o.volume);
  level.inner_volume_stiffness.assign(prisms, o.volume);
  level.skin_bending.assign(columns, o.bending);
  level.smas_bending.assign(columns, o.bending);
  const auto spring = [&](uint32_t first, uint32_t second) {
    level.spring_nodes.push_back({first, second});
    level.spring_stiffness.push_back(o.retinacula);
    level.spring_limit_strain.push_back(0.3F);
    level.spring_second_stiffness.push_back(3.0F * o.retinacula);
    level.spring_one_sided.push_back(0);
  };
  if (o.retinacula > 0.0F)
    for (uint32_t c = 0; c < columns; ++c) {
      spring(c, columns + c);
      spring(columns + c, 2 * columns + c);
    }
  std::set<std::pair<uint32_t, uint32_t>> edges;
  for (const auto& t : level.triangles)
    for (size_t e = 0; e < 3; ++e)
      edges.insert({std::min(t[e], t[(e + 1) % 3]), std::max(t[e], t[(e + 1) % 3])});
  if (o.retinacula > 0.0F)
    for (const auto& [first, second] : edges) {
      spring(first, columns + second);
      spring(second, columns + first);
    }
  if (o.tether_normal > 0.0F || o.tether_tangential > 0.0F)
    for (uint32_t c = 0; c < columns; ++c) {
      level.tether_nodes.push_back(columns + c);
      level.tether_normals.push_back(rig::Vec3f::UnitZ());
      level.tether_normal_stiffness.push_back(o.tether_normal);
      level.tether_tangential_stiffness.push_back(o.tether_tangential);
    }
  return level;
}

/// Adds a fibre of SMAS points along the row `j` from column i0 to i1, its first point on the cranium.
inline void add_fibre(rig::TissueLevel& level, const PatchOptions& o, uint32_t channel, uint32_t j,
                      uint32_t i0, uint32_t i1, float strength) {
  if (level.fibre_offsets.empty()) level.fibre_offsets.push_back(0);
  level.fibre_muscle.push_back(channel);
  level.fibre_channel.push_back(channel);
  level.fibre_strength.push_back(strength);
  level.fibre_shortest.push_back(0.5F);
  const int step = i1 > i0 ? 1 : -1;
  for (int i = static_cast<int>(i0);; i += step) {
    const uint32_t node = level.columns + column_at(o, static_cast<uint32_t>(i), j);
    level.fibre_nodes.push_back({node, node, node});
    level.fibre_weights.push_back(rig::Vec3f(1.0F, 0.0F, 0.0F));
    level.fibre_rest.push_back(level.rest[node]);
    level.fibre_anchor.push_back(i == static_cast<int>(i0) ? rig::FibreEnd::cranium : rig::FibreEnd::smas);
    level.fibre_taper.push_back(1.0F);
    if (i == static_cast<int>(i1)) break;
  }
  level.fibre_offsets.push_back(static_cast<uint32_t>(level.fibre_nodes.size()));
}

/// Adds a carrier of skin node `column` that turns about the x axis through `origin`.
inline void add_carrier(rig::TissueLevel& level, uint32_t channel, uint32_t column, const rig::Vec3f& origin,
                        float angle, float reverse) {
  level.carrier_channel.push_back(channel);
  level.carrier_node.push_back(column);
  level.carrier_origin.push_back(origin);
  level.carrier_axis.push_back(rig::Vec3f(1, 0, 0));
  level.carrier_angle.push_back(angle);
  level.carrier_reverse.push_back(reverse);
  level.carrier_stiffness.push_back(2.0F);
  level.carrier_drive.push_back(2.0F);
}

}  // namespace fascia::testing
