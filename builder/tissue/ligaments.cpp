#include <algorithm>
#include <limits>

#include "builder/tissue/actuators.h"

namespace fascia::tissue {
namespace {

void one_sided(rig::TissueLevel& level, size_t a, size_t b, float stiffness) {
  level.spring_nodes.push_back({static_cast<uint32_t>(a), static_cast<uint32_t>(b)});
  level.spring_stiffness.push_back(stiffness);
  level.spring_limit_strain.push_back(std::numeric_limits<float>::infinity());
  level.spring_second_stiffness.push_back(stiffness);
  level.spring_one_sided.push_back(1);
}

}  // namespace

void add_ligaments(const TissueInputs& inputs, const Columns& c, rig::TissueLevel& level) {
  const auto& [reach, tuft] = inputs.mechanics.ligaments;
  const auto n = static_cast<size_t>(c.count());
  const auto nearest_root = [&](const Vec3& p) {
    size_t best = n;
    double distance = inputs.mechanics.ligaments.reach;
    for (size_t v = 0; v < n; ++v) {
      if (c.rim[v] || !c.outer[v] || !c.bone[v]) continue;
      const double d = (c.inner[v] - p).norm();
      if (d >= distance) continue;
      distance = d;
      best = v;
    }
    return best;
  };
  for (const rig::Ligament& ligament : inputs.ligaments) {
    const Vec3 bone = ligament.bone.cast<double>(), skin = ligament.skin.cast<double>();
    // It ends as a tuft: on all columns near its end, by their area, or on the nearest.
    std::vector<std::pair<size_t, double>> ends;
    double sum = 0.0, closest = reach;
    size_t nearest = n;
    for (size_t v = 0; v < n; ++v) {
      if (c.rim[v] || !c.outer[v]) continue;
      const double d = (c.mesh.vertices[v] - skin).norm(), t = d / tuft;
      if (d < closest) {
        closest = d;
        nearest = v;
      }
      if (t >= 1.0) continue;
      ends.emplace_back(v, c.area[v] * (1.0 - t * t) * (1.0 - t * t));
      sum += ends.back().second;
    }
    if (nearest == n) continue;
    if (ends.empty()) {
      ends.emplace_back(nearest, 1.0);
      sum = 1.0;
    }
    for (const auto& [end, weight] : ends) {
      const size_t root = nearest_root(bone + c.mesh.vertices[end] - skin);
      if (root == n) continue;
      const auto stiffness = static_cast<float>(weight / sum * static_cast<double>(ligament.stiffness));
      one_sided(level, 2 * n + root, n + end, stiffness);
      one_sided(level, n + end, end, stiffness);
    }
  }
}

}  // namespace fascia::tissue
