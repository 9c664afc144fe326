#include "fit/physique.h"

#include <algorithm>
#include <limits>

namespace fascia::fit {
namespace {

/// Bounds of the fraction of its length at which a fibre's force vanishes: those of the lattice.
constexpr float shortest_fibre = 0.05F, longest_fibre = 0.95F;
/// Skeletal muscle shortens by no more than about half its length (Gordon, Huxley & Julian 1966).
constexpr float most_shortening = 0.5F;

float height_of(const rig::Skull& skull, const char* name, float otherwise) {
  for (const rig::Landmark& landmark : skull.landmarks)
    if (landmark.name == name) return landmark.skin.y();
  return otherwise;
}

void scale(std::vector<float>& values, double by) {
  for (float& value : values)
    value *= static_cast<float>(by);
}

}  // namespace

std::vector<size_t> thirds_of_face(const rig::Rig& rig) {
  constexpr float none = std::numeric_limits<float>::lowest();
  const float glabella = height_of(rig.skull, "glabella", none),
              subnasale = height_of(rig.skull, "subnasale", none);
  std::vector<size_t> result;
  for (const rig::Muscle& muscle : rig.muscles) {
    float sum = 0.0F;
    for (const rig::Vec3f& point : muscle.points)
      sum += point.y();
    const float mean = muscle.points.empty() ? 0.0F : sum / static_cast<float>(muscle.points.size());
    result.push_back(mean > glabella ? 0 : mean > subnasale ? 1 : 2);
  }
  return result;
}

rig::Rig with_physique(rig::Rig rig, const Physique& physique) {
  const std::vector<size_t> third = thirds_of_face(rig);
  for (size_t m = 0; m < rig.muscles.size(); ++m)
    rig.muscles[m].peak_shortening = std::min(
        most_shortening, rig.muscles[m].peak_shortening * static_cast<float>(physique.shortening[third[m]]));
  for (rig::TissueLevel& level : rig.tissue.levels) {
    for (size_t f = 0; f < level.fibre_shortest.size(); ++f) {
      if (rig.actuation.channels[level.fibre_channel[f]].group != "muscle") continue;
      const auto by = static_cast<float>(physique.shortening[third[level.fibre_muscle[f]]]);
      if (by != 1.0F)
        level.fibre_shortest[f] =
            std::clamp(1.0F - by * (1.0F - level.fibre_shortest[f]), shortest_fibre, longest_fibre);
    }
    if (physique.stiffness == 1.0) continue;
    for (std::vector<float>* list :
         {&level.spring_stiffness, &level.spring_second_stiffness, &level.skin_membrane, &level.smas_membrane,
          &level.skin_bending, &level.smas_bending, &level.tether_normal_stiffness,
          &level.tether_tangential_stiffness, &level.volume_stiffness, &level.inner_volume_stiffness})
      scale(*list, physique.stiffness);
  }
  return rig;
}

}  // namespace fascia::fit
