#pragma once

#include "builder/skull/skull.h"

namespace fascia::skull {

/// The jaw's frame where `map` puts the generic's condyles; `pose` is the similarity from the generic.
JawFrame jaw_frame(const Generic& generic, const BoneMap& map, const Mat4& pose);

}  // namespace fascia::skull
