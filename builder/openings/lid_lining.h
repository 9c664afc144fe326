#pragma once

#include "builder/openings/lining.h"
#include "builder/prepare/prepare.h"

namespace fascia::openings {

/// The conjunctiva behind lids that were cut: from their edges along the globe to the fornices and around
/// behind it.
Lining lid_lining(const Rim& rim, int first, const MeetingLine& line, const prepare::Eyeball& globe);

}  // namespace fascia::openings
