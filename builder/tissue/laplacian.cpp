#include "builder/tissue/laplacian.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "geometry/error.h"

namespace fascia::tissue {
namespace {

double cotangent(const Vec3& corner, const Vec3& a, const Vec3& b) {
  const Vec3 u = a - corner, v = b - corner;
  return std::clamp(u.dot(v) / std::max(u.cross(v).norm(), 1e-12), -1.0, 10.0);
}

}  // namespace

std::vector<double> vertex_areas(const TriangleMesh& mesh) {
  std::vector<double> areas(mesh.vertices.size(), 0.0);
  for (int t = 0; t < mesh.triangle_count(); ++t)
    for (const int v : mesh.triangles[static_cast<size_t>(t)])
      areas[static_cast<size_t>(v)] += triangle_area(mesh, t) / 3.0;
  return areas;
}

Eigen::SparseMatrix<double> laplacian(const TriangleMesh& mesh, const std::vector<double>& lengths) {
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(12 * mesh.triangles.size());
  for (const fascia::Triangle& t : mesh.triangles)
    for (size_t e = 0; e < 3; ++e) {
      const int a = t[e], b = t[(e + 1) % 3], c = t[(e + 2) % 3];
      const auto at = [&](int v) -> const Vec3& { return mesh.vertices[static_cast<size_t>(v)]; };
      const double w = 0.5 * cotangent(at(c), at(a), at(b)) * lengths[static_cast<size_t>(a)] *
                       lengths[static_cast<size_t>(b)];
      entries.emplace_back(a, a, w);
      entries.emplace_back(b, b, w);
      entries.emplace_back(a, b, -w);
      entries.emplace_back(b, a, -w);
    }
  Eigen::SparseMatrix<double> matrix(mesh.vertex_count(), mesh.vertex_count());
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

SurfaceSmoother::SurfaceSmoother(const TriangleMesh& mesh, const std::vector<double>& lengths)
    : areas_(vertex_areas(mesh)) {
  Eigen::SparseMatrix<double> matrix = laplacian(mesh, lengths);
  for (int v = 0; v < mesh.vertex_count(); ++v)
    matrix.coeffRef(v, v) += areas_[static_cast<size_t>(v)] + 1e-14;
  solver_.compute(matrix);
  if (solver_.info() != Eigen::Success)
    throw Error("the layers beneath the skin cannot be evened out: the face region is degenerate");
}

void SurfaceSmoother::smooth(std::vector<double>& values) const {
  Eigen::VectorXd right(static_cast<Eigen::Index>(values.size()));
  for (size_t v = 0; v < values.size(); ++v)
    right[static_cast<Eigen::Index>(v)] = (areas_[v] + 1e-14) * values[v];
  const Eigen::VectorXd even = solver_.solve(right);
  std::copy(even.begin(), even.end(), values.begin());
}

void SurfaceSmoother::smooth(std::vector<Vec3>& values) const {
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<double> component(values.size());
    for (size_t v = 0; v < values.size(); ++v)
      component[v] = values[v][axis];
    smooth(component);
    for (size_t v = 0; v < values.size(); ++v)
      values[v][axis] = component[v];
  }
}

void SurfaceSmoother::smooth(Eigen::MatrixXd& values) const {
  for (Eigen::Index v = 0; v < values.rows(); ++v)
    values.row(v) *= areas_[static_cast<size_t>(v)] + 1e-14;
  values = solver_.solve(values).eval();
}

}  // namespace fascia::tissue
