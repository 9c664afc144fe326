#include "sim/strain.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

namespace fascia::sim {

void skin_strain(const FaceModel& model, std::span<const Vec3f> displacements, std::span<Strain> out) {
  const Lattice& lattice = model.lattice();
  const Positions& rest = model.rest();
  if (displacements.size() < lattice.node_count() || out.size() < lattice.columns) return;
  std::fill(out.begin(), out.end(), Strain::Zero());
  std::span<const Membrane> skin(model.membranes().data(), lattice.triangles.size());
  for (const Membrane& m : skin) {
    // In the triangle's plane, F = I + grad u: the strain comes from displacements alone, so that rest gives
    // exact zeros.
    const Vec3 first = rest[m.nodes[1]] - rest[m.nodes[0]], second = rest[m.nodes[2]] - rest[m.nodes[0]];
    const Vec3 along = first.normalized(), across = first.cross(second).cross(first).normalized();
    Eigen::Matrix<double, 3, 2> moved, axes;
    moved.col(0) = (displacements[m.nodes[1]] - displacements[m.nodes[0]]).cast<double>();
    moved.col(1) = (displacements[m.nodes[2]] - displacements[m.nodes[0]]).cast<double>();
    axes.col(0) = along;
    axes.col(1) = across;
    const Eigen::Matrix<double, 3, 2> slope = moved * m.inverse_rest;
    const Eigen::Matrix2d plane = axes.transpose() * slope;
    const Eigen::Matrix2d green = 0.5 * (plane + plane.transpose() + slope.transpose() * slope);
    const Mat3 full = axes * green * axes.transpose();
    Strain strain;
    const double parts[6] = {full(0, 0), full(1, 1), full(2, 2), full(0, 1), full(1, 2), full(2, 0)};
    for (int k = 0; k < 6; ++k)
      strain[k] = static_cast<float>(m.area * parts[k]);
    for (const uint32_t node : m.nodes)
      out[node] += strain;
  }
  const std::vector<double>& areas = model.column_areas();
  for (uint32_t c = 0; c < lattice.columns; ++c)
    if (areas[c] > 0.0) out[c] /= static_cast<float>(areas[c]);
}

Vec3f strongest_compression(const Strain& s) {
  if (s.isZero(0.0F)) return Vec3f::Zero();
  Eigen::Matrix3f matrix;
  matrix << s[0], s[3], s[5], s[3], s[1], s[4], s[5], s[4], s[2];
  Eigen::SelfAdjointEigenSolver<Eigen::Matrix3f> solver;
  solver.computeDirect(matrix);
  const float least = solver.eigenvalues()[0];
  if (!(least < 0.0F)) return Vec3f::Zero();
  Vec3f direction = solver.eigenvectors().col(0);
  Eigen::Index largest = 0;
  direction.cwiseAbs().maxCoeff(&largest);
  if (direction[largest] < 0.0F) direction = -direction;
  return (1.0F - std::sqrt(std::max(0.0F, 1.0F + 2.0F * least))) * direction;
}

}  // namespace fascia::sim
