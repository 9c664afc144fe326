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

/// Opens edges on which a small closed patch hangs between two others, as lips do that were modelled for
/// themselves and merged with a face along their outline: the surface then leads from one of the others over
/// the patch to the other instead of past it. Such an edge has four triangles, two of them the patch's own,
/// whose outer sides alternate around it; each is joined to the next one across the air between them. Patches
/// as in `without_flaps`; one with an open border, or with any other non-manifold edge, stays as it is.
///
/// Vertices on such edges are doubled: the new ones follow the mesh's own, which stay with the larger side.
/// The triangles keep their order.
TriangleMesh with_hanging_patches_joined(const TriangleMesh& mesh, double largest = 0.02);

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
