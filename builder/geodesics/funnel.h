#pragma once

#include "builder/geodesics/path.h"

namespace fascia::geodesics {

/// Lays the triangles along `workspace.strip` flat one after the other and pulls the path from `from`
/// to `to` taut inside them (Lee & Preparata 1984), in O(triangles). Afterwards `workspace.taut` lists
/// the nodes of the path: node 0 is `from`, the last is `to`, those between are vertices that bend it
/// or that it touches. The strip must not be empty. Returns the path's length, metres.
double pull_taut(const Surface& surface, const SurfacePoint& from, const SurfacePoint& to,
                 Workspace& workspace);

}  // namespace fascia::geodesics
