#pragma once

#include "builder/landmarks/generic_face.h"
#include "builder/openings/lining.h"
#include "geometry/landmarks.h"

namespace fascia::openings {

/// The lining of the generic head's lips and mouth, bent into this head: by the landmarks they share and by
/// the rim that it hangs on; new vertices are numbered from `first` on.
Lining mouth_lining(const landmarks::GenericFace& face, const anatomy::GenericAnatomy& anatomy,
                    const Landmarks& landmarks, const spatial::SurfaceQuery& skin, const MeetingLine& line,
                    const Rim& rim, int first);

}  // namespace fascia::openings
