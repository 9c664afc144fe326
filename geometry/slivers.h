#pragma once

#include <vector>

#include "geometry/mesh.h"

namespace fascia {

/// `mesh` without triangles lower than `height` (metres; measured over the longest side), whose normals and
/// angles say nothing. No vertex moves: the two ends of a needle's short side become one, a cap's long side
/// is flipped towards the vertex that lies on it, and what can be mended neither way is left out.
///
/// `vertex_map[i]` receives the new index of old vertex i, -1 when it went with the last of its triangles.
/// Meshes without slivers come back as they are. Linear in the triangles but for the few that are mended.
TriangleMesh without_slivers(const TriangleMesh& mesh, double height, std::vector<int>* vertex_map);

}  // namespace fascia
