#pragma once

#include <optional>
#include <string>

#include "builder/openings/line.h"
#include "builder/prepare/prepare.h"

namespace fascia::openings {

/// Whether an eyeball of the head's own stands before its skin where the lids would meet: they are open.
bool eyeball_shows(const prepare::Eyeball& ball, const spatial::SurfaceQuery& skin, const MeetingLine& line);

/// Why the lids along `line`, whose surface goes on across it, may not be closed ones all the same; nothing
/// when they look closed.
///
/// Closed lids meet in one valley, a shallow one where `has_eyeball` says that they lie on an eyeball of the
/// head's own. An eye that is modelled open in one piece with its lids has a step under its upper lid
/// besides.
std::optional<std::string> doubt_of_closed_lids(const spatial::SurfaceQuery& skin, const MeetingLine& line,
                                                const FaceAxes& face, bool has_eyeball);

}  // namespace fascia::openings
