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
  const auto n = static_cast<size_t>(c.count());
  const auto nearest = [&](const Vec3& p, auto&& place, bool on_bone) {
    size_t best = n;
    double distance = 0.012;  // metres: farther off the ligament is not of the simulated part
    for (size_t v = 0; v < n; ++v) {
      if (c.rim[v] || !c.outer[v] || (on_bone && !c.bone[v])) continue;
      const double d = (place(v) - p).norm();
      if (d >= distance) continue;
      distance = d;
      best = v;
    }
    return best;
  };
  for (const rig::Ligament& ligament : inputs.ligaments) {
    const Vec3 bone = ligament.bone.cast<double>(), skin = ligament.skin.cast<double>();
    const size_t root = nearest(bone, [&](size_t v) { return c.inner[v]; }, true);
    const size_t end = nearest(skin, [&](size_t v) { return c.mesh.vertices[v]; }, false);
    if (root == n || end == n) continue;
    one_sided(level, 2 * n + root, n + end, ligament.stiffness);
    one_sided(level, n + end, end, ligament.stiffness);
  }
}

}  // namespace fascia::tissue
