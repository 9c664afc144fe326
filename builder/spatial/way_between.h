#pragma once

#include "builder/spatial/surface_query.h"
#include "geometry/connectivity.h"

namespace fascia::spatial {

/// Length of the shortest path along the mesh's edges from one point on it to another, in the mesh's unit, by
/// Dijkstra's algorithm; `limit` when it is longer. `links` are those of `mesh`.
double way_between(const TriangleMesh& mesh, const Connectivity& links, const RayHit& from, const RayHit& to,
                   double limit);

}  // namespace fascia::spatial
