#pragma once

#include <vector>

#include "geometry/mesh.h"

namespace fascia {

/// `mesh` without triangles lower than `height` (metres; measured over the longest side), whose normals and
/// angles are meaningless. No vertex moves: the short edge of a needle is collapsed, the long edge of a cap
/// is flipped, and triangles that neither operation repairs are removed.
///
/// `vertex_map[i]` receives the new index of old vertex i, -1 if it was removed with the last of its
/// triangles. Meshes without slivers are returned unchanged. Linear in the number of triangles, except for
/// the repaired ones.
TriangleMesh without_slivers(const TriangleMesh& mesh, double height, std::vector<int>* vertex_map);

}  // namespace fascia
