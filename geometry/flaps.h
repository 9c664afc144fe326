#pragma once

#include "geometry/connectivity.h"

namespace fascia {

/// Selects the triangles of `mesh` to keep so that as few non-manifold edges as possible remain: small
/// patches attached to such an edge (fins, inner walls, surplus faces) are removed, the smallest first. A
/// patch is a set of triangles connected by manifold edges; none larger than the share `largest` of the total
/// area is removed.
///
/// Returns one flag per triangle, true to keep it.
std::vector<bool> without_flaps(const TriangleMesh& mesh, double largest = 0.02);

/// Selects the triangles of `mesh` to flip for a consistent orientation: in each patch connected by manifold
/// edges, those of the orientation with less area.
///
/// `original`, if not empty, are the same triangles before vertices were merged, with indices of their own:
/// neighbours there take precedence, so that vertices which merely coincide cannot turn parts of a surface
/// that was oriented consistently.
///
/// Returns one flag per triangle, true to flip it.
std::vector<bool> facing_against(const TriangleMesh& mesh, const std::vector<Triangle>& original = {});

}  // namespace fascia
