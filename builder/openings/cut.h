#pragma once

#include <map>
#include <vector>

#include "builder/openings/path.h"

namespace fascia::openings {

/// A mesh parted along a path. Vertices of the mesh keep their numbers and belong to the upper side where the
/// path passes through them; the path's own places follow, an upper and a lower one each. The first and the
/// last node are the corners, where both sides hang together.
struct Cut {
  Path path;
  int vertex_count = 0;                            ///< of the mesh before
  std::vector<int> upper, lower;                   ///< #nodes, vertex of each side
  std::map<int, std::vector<Triangle>> triangles;  ///< what takes the place of a triangle of the mesh
  Vec3 apart = Vec3::Zero();  ///< from an upper place to its lower one, metres: so little that nobody sees
                              ///< it, and enough that no later reader welds the two
  bool is_lined = false;      ///< more surface hangs on the edges already: lips or lids that had been welded

  /// The node that a new vertex stands at.
  const PathNode& node_of(int vertex) const {
    return path.nodes[static_cast<size_t>((vertex - vertex_count) / 2)];
  }
  bool is_lower(int vertex) const { return vertex >= vertex_count && (vertex - vertex_count) % 2 == 1; }
  int count() const { return vertex_count + 2 * static_cast<int>(path.nodes.size()); }
};

/// Parts `mesh` along `path`.
Cut cut_along(const TriangleMesh& mesh, const Connectivity& links, Path path);

}  // namespace fascia::openings
