#pragma once

#include "builder/tissue/inputs.h"

namespace fascia::tissue {

/// The result of a build by level, with statistics.
struct TissueResult {
  rig::Tissue tissue;
  struct Figures {
    std::string level;
    int nodes = 0, springs = 0, fibres = 0;
    double shortest_edge = 0.0, longest_edge = 0.0;  ///< metres, of the skin layer
    int turned_prisms = 0;                           ///< prisms of no or negative volume at rest
  };
  std::vector<Figures> figures;
  std::vector<std::string> warnings;  ///< limitations due to this head, with remedies
};

/// Builds the lattice at each level of `options` and binds every part to it.
///
/// Throws Error when a landmark or bone is missing, or the mesh has no face between them.
TissueResult build(const TissueInputs& inputs, const TissueOptions& options = {});

}  // namespace fascia::tissue
