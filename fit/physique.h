#pragma once

#include <array>

#include "rig/model/rig.h"

namespace fascia::fit {

/// What tells one person's face from the rig as built, beside how strongly single muscles answer: factors, 1
/// as built.
struct Physique {
  double depth = 1.0;      ///< of soft tissue over bone: the skull lies deeper or nearer under the same skin
  double stiffness = 1.0;  ///< of all tissue beside the muscles that move it
  /// Of muscles' peak shortening, by thirds of the face: above the glabella, down to the subnasale, below it.
  std::array<double, 3> shortening = {1.0, 1.0, 1.0};

  bool operator==(const Physique&) const = default;
};

/// The rig with the physique's stiffness and shortening, at all levels of detail; depth takes another build.
/// Shares of shortening stay within what muscle does.
rig::Rig with_physique(rig::Rig rig, const Physique& physique);

}  // namespace fascia::fit
