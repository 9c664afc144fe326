#pragma once

#include <vector>

#include "geometry/mesh.h"

namespace fascia {

/// The triangles of a surface that is edited in place, linked by half-edges; where its vertices lie is the
/// owner's to keep.
///
/// Half-edge h = 3 t + e runs along edge e of triangle t, from its corner e to corner e + 1. The triangles
/// around a vertex are a fan or a ring; where several fans meet the vertex is `fixed`, and no edit may touch
/// it. Edges of more than two triangles, or of two that face against each other, count as boundary.
class HalfEdges {
 public:
  explicit HalfEdges(const TriangleMesh& mesh);

  std::vector<Triangle> triangles;
  std::vector<int> twin;     ///< the half-edge on the other side, -1 at a boundary
  std::vector<int> leaving;  ///< a half-edge from each vertex, at a boundary the one without a twin; -1: none
  std::vector<char> fixed;

  int from(int h) const { return triangles[static_cast<size_t>(h / 3)][static_cast<size_t>(h % 3)]; }
  int to(int h) const { return from(next(h)); }
  int apex(int h) const { return from(prev(h)); }
  static int next(int h) { return h % 3 == 2 ? h - 2 : h + 1; }
  static int prev(int h) { return h % 3 == 0 ? h + 2 : h - 1; }
  /// The half-edge on the other side of `h`, -1 at a boundary.
  int across(int h) const { return twin[static_cast<size_t>(h)]; }
  bool on_boundary(int v) const {
    const int first = leaving[static_cast<size_t>(v)];
    return first >= 0 && across(first) < 0;
  }

  /// Calls `visit(h)` for the half-edge of each triangle around `v` that leaves it, anticlockwise.
  template <class Visit>
  void around(int v, const Visit& visit) const {
    const int first = leaving[static_cast<size_t>(v)];
    for (int h = first; h >= 0;) {
      visit(h);
      h = across(prev(h));
      if (h == first) return;
    }
  }

  /// Number of triangles around `v`.
  int valence(int v) const;

  /// The vertices around `v`, ascending.
  void ring(int v, std::vector<int>& out) const;

  /// The half-edge from `a` to `b`, -1 when there is none.
  int find(int a, int b) const;
  /// The half-edge between `a` and `b` in either direction, that from `a` first; -1 when there is none.
  int find_either(int a, int b) const;

  /// At a boundary vertex the vertices before and after it along the boundary.
  int before_on_boundary(int v) const;
  int after_on_boundary(int v) const { return to(leaving[static_cast<size_t>(v)]); }

  /// Whether no fixed vertex is a corner of the triangles on both sides of `h`.
  bool may_edit(int h) const;

  /// Turns the edge of `h`, which has a twin, to join the two vertices across it.
  void flip(int h);

  /// Puts a vertex on the edge of `h`, which splits the triangles on both sides; returns its number, the next
  /// one.
  int split(int h);

  /// Merges the other end of `h` into `kept`. Numbers stay as they are until `compact`. The link condition
  /// (common neighbours of the ends are the corners across `h`) is the caller's to see to.
  void collapse(int h, int kept);
  bool gone(int h) const { return dead_triangle_[static_cast<size_t>(h / 3)] != 0; }

  /// Drops what collapses left behind. Returns the old numbers of the vertices that stay, ascending.
  std::vector<int> compact();

 private:
  void link(int g, int h);
  std::vector<char> dead_triangle_, dead_vertex_;
};

/// `values` of those vertices or triangles alone that `stay`, as `HalfEdges::compact` returns them.
template <class T>
void keep_only(const std::vector<int>& stay, std::vector<T>& values) {
  for (size_t i = 0; i < stay.size(); ++i)
    values[i] = values[static_cast<size_t>(stay[i])];
  values.resize(stay.size());
}

}  // namespace fascia
