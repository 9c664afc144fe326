#include <array>

#include "sim/realtime/face.h"

namespace fascia::sim::realtime {
namespace {

constexpr double least = 0.01;  // of a prism's volume at rest, that is left to it
constexpr double thin = 5e-10;  // cubic metres: what may turn in one go
constexpr int passes = 24;      // over neighbours that a node's way back may turn in their stead

Vec3 place_at(const float* list, size_t at) { return {list[at], list[at + 1], list[at + 2]}; }

/// A prism on its way through one substep.
struct Way {
  std::array<Vec3, 6> now, back, corners;  ///< where it is, where it was but for its bones' mean motion, and a place between

  /// Goes back as far as it must for a volume of `room`; false when that is not to be had.
  bool go_back(double room) {
    constexpr double shares[] = {0.5, 0.25, 0.125, 0.0};
    for (const double share : shares) {
      for (size_t k = 0; k < 6; ++k) corners[k] = back[k] + share * (now[k] - back[k]);
      if (volume() > room) return true;
    }
    return false;
  }
  double volume() const { return prism_volume({0, 1, 2, 3, 4, 5}, corners.data()); }
};

}  // namespace

int Face::turn_back(Workspace& work, float* x) const {
  const FaceModel& face = model_->face();
  const auto& triangles = face.lattice().triangles;
  const auto& prisms = face.prisms();
  float* const stiffer = work.gradient.data() + 3;  // where the last look at the energies found walls standing
  const float* const before = work.start.data();
  const float* const begun = work.begun_places.data();
  int moved = 0;
  for (int pass = 0; pass < passes; ++pass) {
    bool is_sound = true;
    for (size_t t = 0; t < triangles.size(); ++t) {
      std::array<bool, 3> risk{};
      for (size_t layer = 0; layer < 3; ++layer)
        for (const uint32_t column : triangles[t]) risk[layer] = risk[layer] || stiffer[16 * static_cast<size_t>(column) + 4 * layer] > 0.0F;
      for (size_t layer = 0; layer < 2; ++layer) {
        const Prism& prism = prisms[layer * triangles.size() + t];
        const double room = least * prism.volume;
        if ((!risk[layer] && !risk[layer + 1] && prism.volume > thin) || !(room > 0.0)) continue;
        std::array<size_t, 6> at{};
        Way way;
        for (size_t k = 0; k < 6; ++k) {
          at[k] = 16 * static_cast<size_t>(triangles[t][k % 3]) + 4 * (layer + k / 3);
          way.now[k] = way.corners[k] = place_at(x, at[k]);
        }
        if (way.volume() > room) continue;
        // Carried along as one it keeps the volume it had, or has that of its bones alone; nodes on bones stay where they are.
        const auto go_back = [&](const float* from, const float* to, const float* shape) {
          Vec3 shift = Vec3::Zero();
          for (const size_t slot : at) shift += (place_at(to, slot) - place_at(from, slot)) / 6.0;
          for (size_t k = 0; k < 6; ++k) way.back[k] = face.prescribed(prism.nodes[k]) ? way.now[k] : Vec3(place_at(shape, at[k]) + shift);
          return way.go_back(room);
        };
        if (!go_back(before, begun, before) && !go_back(work.carried.data(), x, work.carried.data())) continue;
        for (size_t k = 0; k < 6; ++k) {
          for (size_t axis = 0; axis < 3; ++axis) x[at[k] + axis] = static_cast<float>(way.corners[k][static_cast<int>(axis)]);
          stiffer[at[k]] = 1.0F;
        }
        is_sound = false;
        ++moved;
      }
    }
    if (is_sound) break;
  }
  return moved;
}

}  // namespace fascia::sim::realtime
