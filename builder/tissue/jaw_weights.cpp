#include <algorithm>
#include <cmath>

#include "builder/spatial/surface_query.h"
#include "builder/tissue/beneath.h"
#include "builder/tissue/distance.h"
#include "builder/tissue/laplacian.h"
#include "geometry/error.h"

namespace fascia::tissue {
std::vector<double> lower_lip(const TissueInputs& inputs, const TriangleMesh& mesh,
                              const std::vector<bool>& outer, const std::vector<double>& distance) {
  const Vec3 left = landmark(inputs, "cheilion_left"), right = landmark(inputs, "cheilion_right"),
             centre = 0.5 * (left + right);
  const double half = 0.5 * (left - right).norm();
  // Skin that is of one lip for certain: metres from the lips' edge and from the mouth's height, and half
  // widths of the mouth.
  constexpr double nearest = 0.004, farthest = 0.016, height = 0.006, widest = 0.7;
  std::array<std::vector<DistanceSeed>, 2> seeds;
  for (size_t v = 0; v < mesh.vertices.size(); ++v) {
    const Vec3 p = mesh.vertices[v] - centre;
    if (!outer[v] || distance[v] < nearest || distance[v] > farthest || std::abs(p.x()) > widest * half ||
        std::abs(p.y()) < height)
      continue;
    seeds[p.y() < 0.0].push_back({static_cast<int>(v)});
  }
  std::vector<double> lower(mesh.vertices.size(), 0.5);
  if (seeds[0].empty() || seeds[1].empty()) return lower;
  const EdgeDistances above = surface_distances(mesh, seeds[0]), below = surface_distances(mesh, seeds[1]);
  for (size_t v = 0; v < lower.size(); ++v)
    if (std::isfinite(above.distance[v] + below.distance[v]))
      lower[v] = above.distance[v] / std::max(above.distance[v] + below.distance[v], 1e-9);
  return lower;
}

std::vector<double> jaw_weights(const TriangleMesh& mesh, const std::vector<bool>& still, const Bones& bones,
                                const Lips& lips, const anatomy::mechanics::JawInfluence& m) {
  constexpr double undecided = 0.002;  // least weight of a place no bone decides: keeps the field solvable
  const spatial::SurfaceQuery cranium(bones.cranium), mandible(bones.mandible);
  const int n = mesh.vertex_count();
  Eigen::SparseMatrix<double> matrix = laplacian(mesh, std::vector<double>(mesh.vertices.size(), m.spread));
  const std::vector<double> area = vertex_areas(mesh);
  Eigen::VectorXd right = Eigen::VectorXd::Zero(n);
  for (int v = 0; v < n; ++v) {
    const Vec3& p = mesh.vertices[static_cast<size_t>(v)];
    const double share =
        std::max(area[static_cast<size_t>(v)], 1e-14);  // slivers alone may surround a vertex
    const double to_cranium = cranium.closest(p).distance, to_mandible = mandible.closest(p).distance;
    const double near = std::min(to_cranium, to_mandible), far = std::max(to_cranium, to_mandible);
    const double sure = m.certain_ratio.rise(far / std::max(near, 1e-4)) * m.bone_distance.fall(near);
    double weight = share * (undecided + sure),
           goal = to_mandible < to_cranium ? sure / (sure + undecided) : 0.0;
    // Between the lips bone distance is ambiguous, because both rows of teeth are near; lip membership
    // decides. From the corner, which moves half the way, the weight changes along the whole lip.
    const double lip = share * m.lip_fade.fall(lips.distance[static_cast<size_t>(v)]);
    goal = (weight * goal + lip * m.lip_passage.rise(lips.lower[static_cast<size_t>(v)])) / (weight + lip);
    weight += lip;
    if (still[static_cast<size_t>(v)]) {
      weight = 1e3 * share + 1e-6;
      goal = 0.0;
    }
    matrix.coeffRef(v, v) += weight + 1e-14;
    right[v] = weight * goal;
  }
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(matrix);
  if (solver.info() != Eigen::Success)
    throw Error("the jaw's influence on the skin cannot be solved: the face region is degenerate");
  const Eigen::VectorXd field = solver.solve(right);
  std::vector<double> weights(static_cast<size_t>(n));
  for (int v = 0; v < n; ++v) {
    const double value = std::clamp(field[v], 0.0, 1.0);
    weights[static_cast<size_t>(v)] = still[static_cast<size_t>(v)] || value < 1e-4 ? 0.0
                                      : value > 0.999                               ? 1.0
                                                                                    : value;
  }
  return weights;
}

}  // namespace fascia::tissue
