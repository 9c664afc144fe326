#pragma once

#include <array>
#include <vector>

#include "geometry/mesh.h"

namespace fascia {

/// Connectivity of a mesh: neighbours across edges, and the triangles around each vertex.
///
/// Edge `e` of triangle `t` joins its corners `e` and `(e+1)%3`.
struct Connectivity {
  /// Triangle across each edge, -1 at a boundary or a non-manifold edge.
  std::vector<std::array<int, 3>> neighbours;
  /// Triangles around vertex `v`: `vertex_triangles[vertex_offsets[v] .. vertex_offsets[v+1])`.
  std::vector<int> vertex_offsets;
  std::vector<int> vertex_triangles;
  /// Number of non-manifold edges: shared by more than two triangles, or by two triangles with opposite
  /// orientation.
  int irregular_edges = 0;
};

/// One side of a triangle, from corner `edge` to the next.
struct HalfEdge {
  int low, high;  ///< its vertices
  int triangle, edge;
  bool forward;  ///< runs from low to high
};

/// All sides of `triangles`, whose corners are below `vertex_count`, sorted by (low, high, triangle, edge):
/// those of one edge are consecutive. Linear in their number, except for vertices of very many edges.
std::vector<HalfEdge> sorted_half_edges(const std::vector<Triangle>& triangles, size_t vertex_count);

/// Builds the connectivity of `mesh`; any triangle list is accepted.
Connectivity connectivity(const TriangleMesh& mesh);

/// Boundary loops as closed vertex sequences (first vertex not repeated), following the triangles'
/// direction, longest first.
std::vector<std::vector<int>> boundary_loops(const TriangleMesh& mesh, const Connectivity& links);

/// Connected component of each triangle (by shared vertices), numbered from 0 in the order of their first
/// triangle; `count`, if not null, receives their number.
std::vector<int> components(const TriangleMesh& mesh, int* count = nullptr);

/// Merges vertices closer than `tolerance` (metres); `vertex_map[i]` receives the new index of old vertex i.
/// Degenerate triangles are removed.
TriangleMesh weld(const TriangleMesh& mesh, double tolerance, std::vector<int>* vertex_map);

/// The part of `mesh` whose triangles have `keep` set; `vertex_map[i]` receives the new index of old
/// vertex i, or -1.
TriangleMesh submesh(const TriangleMesh& mesh, const std::vector<bool>& keep, std::vector<int>* vertex_map);

}  // namespace fascia
