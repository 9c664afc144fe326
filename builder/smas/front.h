#pragma once

#include <algorithm>
#include <vector>

#include "builder/smas/vertex_grid.h"
#include "geometry/mesh.h"

namespace fascia::smas {

/// A growing triangle mesh with its open border as linked loops of directed edges.
///
/// The free side of front edge i -> j is to its right, seen against the normal; the triangle that
/// fills it is (j, i, v), and the loop goes on as i -> v -> j. A vertex can lie on several loops at a
/// time (two fronts that touch): it then has one outgoing front edge for each.
class Front {
 public:
  struct Edge {
    int from, to;
    int prev, next;  // along the loop
    int opposite;    // third corner of the triangle on the meshed side
    bool alive;
  };

  /// `edge_length`: of most edges.
  explicit Front(double edge_length) : all(edge_length), open(3.0 * edge_length) {}

  int add_vertex(const Vec3& position, const Vec3& normal, double size);

  /// Starts a part: triangle (a, b, c) whose three edges are a loop. Returns its first edge.
  int add_first_triangle(int a, int b, int c);

  /// Fills front edge `e` with a triangle to vertex `apex`, which is new, a neighbour of `e` along the
  /// loop, or on a front elsewhere. Returns false, changing nothing, when the mesh would not stay
  /// manifold. Front edges that come to be are appended to `edges`.
  bool connect(int e, int apex);

  /// The outgoing front edge at `vertex` whose free sector holds the direction to `point`, or -1.
  int sector(int vertex, const Vec3& point) const;

  /// Whether the direction from `edges[e].from` to `point` lies in the free sector before `e`.
  bool in_sector(int e, const Vec3& point) const;

  bool on_front(int vertex) const { return !outgoing[vertex].empty(); }

  TriangleMesh mesh;
  std::vector<Vec3> normals;
  std::vector<double> sizes;
  std::vector<Edge> edges;
  std::vector<std::vector<int>> outgoing;  // alive front edges that leave each vertex
  VertexGrid all, open;                    // every vertex; those on a front

 private:
  bool has_edge(int a, int b) const {
    return std::find(joined_[a].begin(), joined_[a].end(), b) != joined_[a].end();
  }
  int add_edge(int from, int to, int opposite);
  void kill(int e);
  bool fill(int e, int apex);
  void link(int e, int next) { edges[e].next = next, edges[next].prev = e; }

  std::vector<std::vector<int>> joined_;  // vertices that each vertex has an edge with
};

}  // namespace fascia::smas
