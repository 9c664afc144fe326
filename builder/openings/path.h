#pragma once

#include <vector>

#include "builder/openings/line.h"
#include "geometry/connectivity.h"

namespace fascia::openings {

/// A place where a path over a mesh passes: a vertex of the mesh (`b` is -1), or a point of the edge from `a`
/// to `b`, `a` < `b`.
struct PathNode {
  int a = -1, b = -1;
  double share = 0.0;  ///< of `b`
  bool is_vertex() const { return b < 0; }
  bool operator==(const PathNode& other) const { return a == other.a && b == other.b; }
};

/// A path through the triangles of a mesh, from the right to the left. Between two nodes it crosses a
/// triangle or runs along an edge.
struct Path {
  std::vector<PathNode> nodes;
  std::vector<int> triangles;  ///< #nodes - 1; -1 where it runs along an edge
  std::vector<double> above;  ///< #vertices, height over the line; exactly 0 where the path may pass a vertex
};

Vec3 position(const TriangleMesh& mesh, const PathNode& node);

/// Follows the line over the outer surface of `mesh` from `-end` to `end` of it (as `MeetingLine::along`
/// counts). It passes through a vertex where it would cut an edge nearer to one than a fifth of the edge, so
/// that it cuts off no slivers. Empty when the surface does not go on all the way.
Path trace(const TriangleMesh& mesh, const Connectivity& links, const spatial::SurfaceQuery& surface,
           const MeetingLine& line, double end);

}  // namespace fascia::openings
