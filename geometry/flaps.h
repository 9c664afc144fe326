#pragma once

#include "geometry/connectivity.h"

namespace fascia {

/// Which triangles of `mesh` to keep so that as few edges as possible have more than two: small patches that
/// hang on such an edge (fins, inner walls, left-over faces) are left out, smallest first. A patch is what
/// hangs together across edges of two triangles; none larger than `largest` of the whole area goes.
///
/// Returns one flag a triangle, true where it stays.
std::vector<bool> without_flaps(const TriangleMesh& mesh, double largest = 0.02);

/// Which triangles of `mesh` to turn over so that neighbours face the same way: in each patch of triangles
/// that share edges by two, those on the side of less area. Edges of more than two triangles part patches.
///
/// Returns one flag a triangle, true where it faces against its patch.
std::vector<bool> facing_against(const TriangleMesh& mesh);

}  // namespace fascia
