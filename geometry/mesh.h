#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace fascia {

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;
using Mat4 = Eigen::Matrix4d;
using Triangle = std::array<int, 3>;

/// A triangle surface: `vertices` in metres unless a function says otherwise, `triangles` as
/// counter-clockwise vertex indices seen from outside.
struct TriangleMesh {
  std::vector<Vec3> vertices;
  std::vector<Triangle> triangles;

  bool empty() const { return triangles.empty(); }
  int vertex_count() const { return static_cast<int>(vertices.size()); }
  int triangle_count() const { return static_cast<int>(triangles.size()); }
};

/// A point on a triangle mesh: `triangle` index and `barycentric` weights (sum 1) of its corners.
struct SurfacePoint {
  int triangle = -1;
  Vec3 barycentric = Vec3::Zero();
};

/// Axis-aligned bounds of a set of points.
struct Bounds {
  Vec3 lower = Vec3::Constant(1e300);
  Vec3 upper = Vec3::Constant(-1e300);
  Vec3 size() const { return upper - lower; }
  Vec3 centre() const { return 0.5 * (lower + upper); }
};

/// Position of `point` on `mesh`.
Vec3 position(const TriangleMesh& mesh, const SurfacePoint& point);

/// Unit normal of triangle `triangle`; zero for a degenerate triangle.
Vec3 triangle_normal(const TriangleMesh& mesh, int triangle);

/// Area of triangle `triangle`, in the square of the mesh's unit.
double triangle_area(const TriangleMesh& mesh, int triangle);

/// Height of a triangle over its longest side, in the unit of its corners; 0 where they are one point.
double triangle_height(const Vec3& a, const Vec3& b, const Vec3& c);

/// Of each of `positions`, the sum of the area vectors of `triangles` about it.
std::vector<Vec3> vertex_area_vectors(const std::vector<Vec3>& positions,
                                      const std::vector<Triangle>& triangles);

/// Area-weighted unit vertex normals, one per vertex; zero for vertices without area around them.
std::vector<Vec3> vertex_normals(const TriangleMesh& mesh);

/// `point` transformed by the affine map `map`.
Vec3 transform_point(const Mat4& map, const Vec3& point);

/// Bounds of `points`; without points, lower > upper.
Bounds bounds(const std::vector<Vec3>& points);

}  // namespace fascia
