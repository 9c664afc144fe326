#pragma once

#include <array>
#include <vector>

#include "geometry/mesh.h"

namespace fascia {

/// Which triangles meet where: neighbours across edges, and the triangles around each vertex.
///
/// Edge `e` of triangle `t` joins its corners `e` and `(e+1)%3`.
struct Connectivity {
  /// Triangle across each edge, -1 at a boundary or where more than two triangles share the edge.
  std::vector<std::array<int, 3>> neighbours;
  /// Triangles around vertex `v`: `vertex_triangles[vertex_offsets[v] .. vertex_offsets[v+1])`.
  std::vector<int> vertex_offsets;
  std::vector<int> vertex_triangles;
  /// Edges that more than two triangles share, or that two triangles run in the same direction.
  int irregular_edges = 0;
};

/// One side of a triangle, from corner `edge` to the next.
struct HalfEdge {
  int low, high;  ///< its vertices
  int triangle, edge;
  bool forward;  ///< runs from low to high
};

/// All sides of `triangles`, whose corners are below `vertex_count`, sorted by (low, high, triangle, edge):
/// those of one edge follow each other. Linear in their number but for vertices of very many edges.
std::vector<HalfEdge> sorted_half_edges(const std::vector<Triangle>& triangles, size_t vertex_count);

/// Builds the connectivity of `mesh`; any triangle list is accepted.
Connectivity connectivity(const TriangleMesh& mesh);

/// Boundary loops as closed vertex sequences (first vertex not repeated), following the triangles'
/// direction, longest first.
std::vector<std::vector<int>> boundary_loops(const TriangleMesh& mesh, const Connectivity& links);

/// Connected component of each triangle (by shared vertices), numbered from 0 in the order of first
/// triangle; `count` receives how many there are when not null.
std::vector<int> components(const TriangleMesh& mesh, int* count = nullptr);

/// Merges vertices closer than `tolerance` (metres); `vertex_map[i]` receives the new index of old
/// vertex i. Triangles that lose a corner are dropped.
TriangleMesh weld(const TriangleMesh& mesh, double tolerance, std::vector<int>* vertex_map);

/// The part of `mesh` whose triangles have `keep` set; `vertex_map[i]` receives the new index of old
/// vertex i, or -1.
TriangleMesh submesh(const TriangleMesh& mesh, const std::vector<bool>& keep, std::vector<int>* vertex_map);

}  // namespace fascia
