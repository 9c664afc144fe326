#pragma once

#include "builder/openings/lining.h"
#include "builder/openings/openings.h"

namespace fascia::openings {

/// Carries a cut of the welded skin and its lining over to the skin and the user's meshes; returns how many
/// vertices the user's meshes gained.
int apply(const Cut& cut, const Lining& lining, prepare::PreparedHead& head, OpenedHead& opened,
          bool is_inside_out);

}  // namespace fascia::openings
