#pragma once

#include <vector>

#include "geometry/half_edges.h"

namespace fascia::smas {

/// A surface that is edited in place, with the normal and the edge length asked for at every vertex.
struct SurfaceMesh : HalfEdges {
  std::vector<Vec3> points, normals;
  std::vector<double> sizes;

  SurfaceMesh(const TriangleMesh& mesh, const std::vector<Vec3>& vertex_normals,
              const std::vector<double>& vertex_sizes)
      : HalfEdges(mesh), points(mesh.vertices), normals(vertex_normals), sizes(vertex_sizes) {}

  double length(int h) const {
    return (points[static_cast<size_t>(from(h))] - points[static_cast<size_t>(to(h))]).norm();
  }
  double wanted(int h) const {
    return 0.5 * (sizes[static_cast<size_t>(from(h))] + sizes[static_cast<size_t>(to(h))]);
  }

  /// Splits the edge of `h` at a vertex with these attributes.
  void split(int h, const Vec3& point, const Vec3& normal, double size) {
    HalfEdges::split(h);
    points.push_back(point);
    normals.push_back(normal);
    sizes.push_back(size);
  }

  std::vector<int> compact() {
    std::vector<int> stay = HalfEdges::compact();
    keep_only(stay, points);
    keep_only(stay, normals);
    keep_only(stay, sizes);
    return stay;
  }
};

}  // namespace fascia::smas
