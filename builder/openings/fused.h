#pragma once

#include "builder/openings/line.h"
#include "geometry/connectivity.h"

namespace fascia::openings {

/// Whether the surface goes on across the line where lips or lids should part: from above it to below it the
/// way along the surface is short, where an opening would send it around the corners or through the inside.
///
/// A groove along the line, up to some 8 mm deep on a grown person's mouth, counts as closed still.
bool is_fused(const TriangleMesh& mesh, const Connectivity& links, const spatial::SurfaceQuery& surface,
              const MeetingLine& line);

}  // namespace fascia::openings
