#pragma once

#include <vector>

#include "geometry/mesh.h"

namespace fascia::smas {

/// A triangle mesh that is edited in place: half-edges, and at every vertex its normal and the edge length
/// asked for there.
///
/// Half-edge h = 3 t + e runs along edge e of triangle t, from its corner e to corner e + 1. The triangles
/// around a vertex are a fan or a ring; where several fans meet the vertex is `fixed`, and no edit touches
/// it.
struct SurfaceMesh {
  std::vector<Vec3> points, normals;
  std::vector<double> sizes;
  std::vector<Triangle> triangles;
  std::vector<int> twin;     ///< the half-edge on the other side, -1 at a boundary
  std::vector<int> leaving;  ///< a half-edge from each vertex, at a boundary the one without a twin; -1: none
  std::vector<char> fixed;

  SurfaceMesh(const TriangleMesh& mesh, const std::vector<Vec3>& normals, const std::vector<double>& sizes);

  int from(int h) const { return triangles[h / 3][h % 3]; }
  int to(int h) const { return from(next(h)); }
  int apex(int h) const { return from(prev(h)); }
  static int next(int h) { return h % 3 == 2 ? h - 2 : h + 1; }
  static int prev(int h) { return h % 3 == 0 ? h + 2 : h - 1; }
  bool on_boundary(int v) const { return leaving[v] >= 0 && twin[leaving[v]] < 0; }
  double length(int h) const { return (points[from(h)] - points[to(h)]).norm(); }
  double wanted(int h) const { return 0.5 * (sizes[from(h)] + sizes[to(h)]); }

  /// Calls `visit(h)` for the half-edge of each triangle around `v` that leaves it, anticlockwise.
  template <class Visit>
  void around(int v, const Visit& visit) const {
    const int first = leaving[v];
    for (int h = first; h >= 0;) {
      visit(h);
      h = twin[prev(h)];
      if (h == first) return;
    }
  }

  /// Number of triangles around `v`.
  int valence(int v) const;

  /// The half-edge from `a` to `b`, -1 when there is none.
  int find(int a, int b) const;

  /// At a boundary vertex the vertices before and after it along the boundary.
  int before_on_boundary(int v) const;
  int after_on_boundary(int v) const { return to(leaving[v]); }

  /// Whether no fixed vertex is a corner of the triangles on both sides of `h`.
  bool may_edit(int h) const;

  /// Turns the edge of `h`, which has a twin, to join the two vertices across it.
  void flip(int h);

  /// Puts a vertex on the edge of `h`, which splits the triangles on both sides. Returns its number.
  int split(int h, const Vec3& point, const Vec3& normal, double size);

  /// Merges the other end of `h` into `kept`. Numbers stay as they are until `compact`.
  void collapse(int h, int kept);
  bool gone(int h) const { return dead_triangle_[h / 3] != 0; }

  /// Drops what collapses left behind. Returns the old numbers of the vertices that stay.
  std::vector<int> compact();

 private:
  void link(int g, int h);
  void replace_leaving(int v, int gone, int by) {
    if (leaving[v] == gone) leaving[v] = by;
  }
  std::vector<char> dead_triangle_, dead_vertex_;
};

}  // namespace fascia::smas
