#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

#include "builder/spatial/surface_query.h"
#include "builder/tissue/columns.h"
#include "geometry/error.h"

namespace fascia::tissue {
namespace {

double smoothstep(double low, double high, double x) {
  const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return t * t * (3.0 - 2.0 * t);
}

/// Cotangent weights of the edges of each triangle, kept positive.
double cotangent(const Vec3& corner, const Vec3& a, const Vec3& b) {
  const Vec3 u = a - corner, v = b - corner;
  return std::clamp(u.dot(v) / std::max(u.cross(v).norm(), 1e-12), 0.05, 10.0);
}

}  // namespace

std::vector<double> jaw_weights(const TriangleMesh& mesh, const std::vector<bool>& rim, const Bones& bones, const Mouth& mouth) {
  constexpr double spread = 0.008;  // metres over which the field goes from one bone to the other
  const spatial::SurfaceQuery cranium(bones.cranium), mandible(bones.mandible);
  const int n = mesh.vertex_count();
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::VectorXd right = Eigen::VectorXd::Zero(n), area = Eigen::VectorXd::Zero(n);
  for (int t = 0; t < mesh.triangle_count(); ++t) {
    const fascia::Triangle& k = mesh.triangles[static_cast<size_t>(t)];
    for (size_t e = 0; e < 3; ++e) {
      const int a = k[e], b = k[(e + 1) % 3], c = k[(e + 2) % 3];
      area[a] += triangle_area(mesh, t) / 3.0;
      const double w = 0.5 * cotangent(mesh.vertices[static_cast<size_t>(c)], mesh.vertices[static_cast<size_t>(a)],
                                       mesh.vertices[static_cast<size_t>(b)]) * spread * spread;
      entries.emplace_back(a, a, w);
      entries.emplace_back(b, b, w);
      entries.emplace_back(a, b, -w);
      entries.emplace_back(b, a, -w);
    }
  }
  for (int v = 0; v < n; ++v) {
    const Vec3& p = mesh.vertices[static_cast<size_t>(v)];
    const double to_cranium = cranium.closest(p).distance, to_mandible = mandible.closest(p).distance;
    const double near = std::min(to_cranium, to_mandible), far = std::max(to_cranium, to_mandible);
    const double sure = smoothstep(1.25, 2.2, far / std::max(near, 1e-4)) * (1.0 - smoothstep(0.018, 0.035, near));
    double weight = area[v] * (0.002 + sure), goal = to_mandible < to_cranium ? sure / (sure + 0.002) : 0.0;
    // Bones are no guide between the lips, where both rows of teeth are near; which lip it is, is.
    const double side = p.y() - mouth.centre.y(), out = std::abs(p.x() - mouth.centre.x()) / mouth.half_width;
    const double lip = smoothstep(0.003, 0.006, std::abs(side)) * (1.0 - smoothstep(0.010, 0.016, mouth.distance[static_cast<size_t>(v)])) *
                       (1.0 - smoothstep(0.5, 0.9, out));
    goal = (weight * goal + (side < 0.0 ? area[v] * lip : 0.0)) / (weight + area[v] * lip);
    weight += area[v] * lip;
    if (rim[static_cast<size_t>(v)]) {
      weight = 1e3 * area[v] + 1e-6;
      goal = 0.0;
    }
    entries.emplace_back(v, v, weight + 1e-14);
    right[v] = weight * goal;
  }
  Eigen::SparseMatrix<double> matrix(n, n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(matrix);
  if (solver.info() != Eigen::Success) throw Error("the jaw's influence on the skin cannot be solved: the face region is degenerate");
  const Eigen::VectorXd field = solver.solve(right);
  std::vector<double> weights(static_cast<size_t>(n));
  for (int v = 0; v < n; ++v) {
    const double value = std::clamp(field[v], 0.0, 1.0);
    weights[static_cast<size_t>(v)] = rim[static_cast<size_t>(v)] || value < 1e-4 ? 0.0 : value > 0.999 ? 1.0 : value;
  }
  return weights;
}

}  // namespace fascia::tissue
