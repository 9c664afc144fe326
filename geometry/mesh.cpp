#include "geometry/mesh.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace fascia {

namespace {

Vec3 area_vector(const std::vector<Vec3>& positions, const Triangle& triangle) {
  const auto& [a, b, c] = triangle;
  return 0.5 * (positions[b] - positions[a]).cross(positions[c] - positions[a]);
}

Vec3 area_vector(const TriangleMesh& mesh, int triangle) {
  return area_vector(mesh.vertices, mesh.triangles[triangle]);
}

Vec3 unit_or_zero(const Vec3& v) {
  const double length = v.norm();
  return length > 0.0 ? Vec3(v / length) : Vec3(Vec3::Zero());
}

}  // namespace

Vec3 position(const TriangleMesh& mesh, const SurfacePoint& point) {
  const Triangle& corners = mesh.triangles[point.triangle];
  return point.barycentric[0] * mesh.vertices[corners[0]] + point.barycentric[1] * mesh.vertices[corners[1]] +
         point.barycentric[2] * mesh.vertices[corners[2]];
}

Vec3 triangle_normal(const TriangleMesh& mesh, int triangle) {
  return unit_or_zero(area_vector(mesh, triangle));
}

double triangle_area(const TriangleMesh& mesh, int triangle) {
  return area_vector(mesh, triangle).norm();
}

double triangle_height(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double longest = std::max({(b - a).norm(), (c - b).norm(), (a - c).norm()});
  return longest > 0.0 ? (b - a).cross(c - a).norm() / longest : 0.0;
}

std::vector<Vec3> vertex_area_vectors(const std::vector<Vec3>& positions,
                                      const std::vector<Triangle>& triangles) {
  std::vector<Vec3> sums(positions.size(), Vec3::Zero());
  for (const Triangle& triangle : triangles) {
    const Vec3 area = area_vector(positions, triangle);
    for (int corner : triangle)
      sums[corner] += area;
  }
  return sums;
}

std::vector<Vec3> vertex_normals(const TriangleMesh& mesh) {
  std::vector<Vec3> normals = vertex_area_vectors(mesh.vertices, mesh.triangles);
  for (Vec3& normal : normals)
    normal = unit_or_zero(normal);
  return normals;
}

Vec3 transform_point(const Mat4& map, const Vec3& point) {
  return map.topLeftCorner<3, 3>() * point + map.topRightCorner<3, 1>();
}

Bounds bounds(const std::vector<Vec3>& points) {
  Bounds box;
  for (const Vec3& point : points) {
    box.lower = box.lower.cwiseMin(point);
    box.upper = box.upper.cwiseMax(point);
  }
  return box;
}

}  // namespace fascia
