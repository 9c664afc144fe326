#pragma once

#include <vector>

#include "builder/tissue/inputs.h"

namespace fascia::tissue {

/// #skin vertices: whether each is part of an eye in one surface with its lids, as in scans and statues: the
/// lids move in front of it, and it is fixed. None for an eye with an eyeball, an empty socket or closed
/// lids.
std::vector<bool> eyes_in_skin(const TissueInputs& inputs);

/// Closes in `blocking` (metres) the fissures of eyes that are empty sockets, so that what lies in them is
/// not seen from outside.
void hang_curtains(const TissueInputs& inputs, TriangleMesh& blocking);

}  // namespace fascia::tissue
