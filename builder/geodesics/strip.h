#pragma once

#include "builder/geodesics/path.h"

namespace fascia::geodesics {

/// Fills `workspace.strip` with the edges crossed on the way from `from` to `to` by steps towards `to`
/// projected into each triangle, sliding along ridges, valleys and rims. Returns false when the walk
/// stalls: in the corner of a rim, or when it returns to a triangle it has left.
bool trace_strip(const Surface& surface, const SurfacePoint& from, const SurfacePoint& to, Workspace& workspace);

/// Fills `workspace.strip` with the strip that is shortest through edge midpoints (A*). Both ends must
/// be in one piece. Returns the number of edges visited.
int search_strip(const Surface& surface, const SurfacePoint& from, const SurfacePoint& to, Workspace& workspace);

}  // namespace fascia::geodesics
