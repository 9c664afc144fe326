#pragma once

#include <array>
#include <vector>

#include "rig/model/rig.h"

namespace fascia::fit {

/// Differences between a person's face and the rig as built, apart from the gains of single muscles: factors,
/// 1 as built.
struct Physique {
  double depth = 1.0;      ///< of soft-tissue depth: the skull is deeper or shallower under the same skin
  double stiffness = 1.0;  ///< of all tissue relative to the muscles
  /// Of muscles' peak shortening, by thirds of the face: above the glabella, down to the subnasale, below it.
  std::array<double, 3> shortening = {1.0, 1.0, 1.0};
  /// Of the regions that mimic muscles attach to, across their course, and of the bands of those around
  /// orifices, by the same thirds.
  std::array<double, 3> breadth = {1.0, 1.0, 1.0};

  bool operator==(const Physique&) const = default;
  /// Whether the anatomy is another, so that the rig has to be built again.
  bool takes_build() const { return depth != 1.0 || breadth != std::array{1.0, 1.0, 1.0}; }
};

/// By muscle of the rig: the third of the face in which it lies: 0 above the glabella, 1 down to the
/// subnasale, 2 below it.
std::vector<size_t> thirds_of_face(const rig::Rig& rig);

/// The rig with the physique's stiffness and shortening, at all levels of detail; a change of depth or
/// breadth requires rebuilding. Peak shortening is limited to the physiological range.
rig::Rig with_physique(rig::Rig rig, const Physique& physique);

}  // namespace fascia::fit
