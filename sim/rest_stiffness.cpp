#include "sim/rest_stiffness.h"

#include <Eigen/Geometry>
#include <Eigen/LU>

namespace fascia::sim {
namespace {

using Triplets = std::vector<Eigen::Triplet<double>>;

/// Adds weight * c c^T, c the coefficients of `count` nodes.
void add_square(const uint32_t* nodes, const double* coefficients, size_t count, double weight,
                const std::vector<int32_t>& unknown, Triplets& out) {
  for (size_t i = 0; i < count; ++i)
    for (size_t j = 0; j < count; ++j)
      if (unknown[nodes[i]] >= 0 && unknown[nodes[j]] >= 0)
        out.emplace_back(unknown[nodes[i]], unknown[nodes[j]], weight * coefficients[i] * coefficients[j]);
}

/// Adds weight * the sum over axes of g g^T, g the `count` nodes' gradients along an axis: each pair once.
template <int axes>
void add_squares(const uint32_t* nodes, const Eigen::Matrix<double, axes, 1>* gradients, size_t count,
                 double weight, const std::vector<int32_t>& unknown, Triplets& out) {
  for (size_t i = 0; i < count; ++i)
    for (size_t j = 0; j < count; ++j)
      if (unknown[nodes[i]] >= 0 && unknown[nodes[j]] >= 0)
        out.emplace_back(unknown[nodes[i]], unknown[nodes[j]], weight * gradients[i].dot(gradients[j]));
}

void add_membrane(const Membrane& m, const std::vector<int32_t>& unknown, Triplets& out) {
  Eigen::Vector2d gradients[3];  // of the corner functions, in the triangle's plane
  gradients[1] = m.inverse_rest.row(0).transpose();
  gradients[2] = m.inverse_rest.row(1).transpose();
  gradients[0] = -gradients[1] - gradients[2];
  add_squares<2>(m.nodes.data(), gradients, 3, m.area * (2.0 * m.mu + 0.5 * m.lambda), unknown, out);
}

void add_prism(const Prism& p, const Positions& x, const std::vector<int32_t>& unknown, Triplets& out) {
  if (p.stiffness == 0.0) return;
  const auto gradient = prism_volume_gradient(p.nodes, x.data());
  add_squares<3>(p.nodes.data(), gradient.data(), 6, p.stiffness / std::max(std::abs(p.volume), 1e-12),
                 unknown, out);
}

}  // namespace

Eigen::SparseMatrix<double> assemble_rest_stiffness(const RestTerms& t) {
  Triplets triplets;
  const double ends[2] = {1.0, -1.0}, one = 1.0;
  for (const Spring& s : t.springs)
    add_square(s.nodes.data(), ends, 2, s.stiffness, t.unknown_of_node, triplets);
  for (const Membrane& m : t.membranes)
    add_membrane(m, t.unknown_of_node, triplets);
  for (const Hinge& h : t.hinges)
    add_square(h.nodes.data(), h.weights.data(), 4, h.stiffness, t.unknown_of_node, triplets);
  for (const Prism& p : t.prisms)
    add_prism(p, t.rest, t.unknown_of_node, triplets);
  for (const Tether& h : t.tethers)
    add_square(&h.node, &one, 1, (h.normal_stiffness + 2.0 * h.tangential_stiffness) / 3.0, t.unknown_of_node,
               triplets);
  // A small diagonal term keeps the factor positive definite.
  for (size_t i = 0; i < t.unknowns; ++i) {
    const auto k = static_cast<int>(i);
    triplets.emplace_back(k, k, 1e-6);
  }
  const auto size = static_cast<Eigen::Index>(t.unknowns);
  Eigen::SparseMatrix<double> matrix(size, size);
  matrix.setFromTriplets(triplets.begin(), triplets.end());
  return matrix;
}

}  // namespace fascia::sim
