#pragma once

#include <Eigen/SparseCore>
#include <vector>

#include "sim/energies.h"

namespace fascia::sim {

/// The elements at rest that `assemble_rest_stiffness` sums.
struct RestTerms {
  const std::vector<Spring>& springs;
  const std::vector<Membrane>& membranes;
  const std::vector<Hinge>& hinges;
  const std::vector<Prism>& prisms;
  const std::vector<Tether>& tethers;
  const Positions& rest;
  const std::vector<int32_t>& unknown_of_node;  ///< -1 where prescribed
  size_t unknowns;
};

/// A stiffness matrix over the unknown nodes that x, y and z share, an approximation of the Hessian of the
/// rest pose in which every element is isotropic. Newton per metre, symmetric.
Eigen::SparseMatrix<double> assemble_rest_stiffness(const RestTerms& terms);

}  // namespace fascia::sim
