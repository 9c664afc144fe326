#pragma once

#include <string>

#include "anatomy/anatomy.h"
#include "builder/skull/skull.h"

namespace fascia::skull {

/// What the skull fit needs of `anatomy`: skull meshes, generic skin, landmarks with the depths of the table
/// named `depth_table` (empty: the default one), condyle centres.
///
/// Landmarks of both surfaces whose depth no table knows take the generic's own and a deviation of 3 mm.
/// Throws Error when the skull has no cranium or mandible, or the table does not exist.
Generic from_anatomy(const anatomy::GenericAnatomy& anatomy, const std::string& depth_table = {});

}  // namespace fascia::skull
