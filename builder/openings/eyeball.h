#pragma once

#include "builder/openings/line.h"
#include "builder/prepare/prepare.h"
#include "formats/scene.h"

namespace fascia::openings {

/// An eyeball for an eye of this head: of a grown person's size in proportion to the face, as far forward as
/// its lids, closed over it, let it.
///
/// `line` is where the lids meet.
prepare::Eyeball fit_globe(const spatial::SurfaceQuery& skin, const MeetingLine& line, const FaceAxes& face);

/// The generic head's eyeball of a side as large as `ball` and in its place, looking straight ahead of the
/// face; metres, rig frame, coloured by iris, pupil and sclera. Empty when the anatomy has none.
formats::SceneMesh eyeball_mesh(const anatomy::GenericAnatomy& anatomy, const prepare::Eyeball& ball,
                                const FaceAxes& face, bool left);

}  // namespace fascia::openings
