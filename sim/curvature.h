#pragma once

#include <array>
#include <vector>

#include "sim/energies.h"

namespace fascia::sim {

/// A positive semidefinite approximation of the Hessian of a face's energy, element by element: each
/// element's Hessian projected to its non-negative eigenvalues (Teran et al. 2005, "Robust quasistatic finite
/// elements and flesh simulation", section 5). Newton steps with it are always descent directions.
///
/// Lists are by node; applying it does not allocate; assembling it may, until the lists have reached their
/// size.
class Curvature {
 public:
  /// Force on node i: weight_i block sum(weight_j v_j).
  template <size_t Count>
  struct Stencil {
    std::array<uint32_t, Count> nodes;
    std::array<double, Count> weights;
    Mat3 block;
  };
  struct Plate {
    std::array<uint32_t, 3> nodes;
    Eigen::Matrix2d inverse_rest;
    Eigen::Matrix<double, 6, 6> block;  ///< over the deformation gradient's two columns
  };
  /// Force on node i: stiffness slope_i^T sum(slope_j v_j).
  struct Bend {
    std::array<uint32_t, 4> nodes;
    std::array<Mat3, 4> slopes;
    double stiffness;
  };
  struct Volume {
    std::array<uint32_t, 6> nodes;
    std::array<Vec3, 6> slopes;
    double stiffness;
  };
  /// The same for a fibre, whose nodes are many: `first` and `count` in `pull_nodes` and `pull_slopes`.
  struct Pull {
    size_t first, count;
    double stiffness;
  };

  std::vector<Stencil<1>> points;
  std::vector<Stencil<2>> pairs;
  std::vector<Stencil<4>> quads;
  std::vector<Stencil<6>> sixes;
  std::vector<Plate> plates;
  std::vector<Bend> bends;
  std::vector<Volume> volumes;
  std::vector<Pull> pulls;
  std::vector<uint32_t> pull_nodes;
  std::vector<Vec3> pull_slopes;

  void clear();
  /// Adds the forces (#nodes) of the displacements `v` (#nodes) to `out`.
  void times(const Vec3* v, Vec3* out) const;
};

/// Each adds its element's contribution at `x`.
void add_spring(const Spring& spring, const Vec3* x, Curvature& out);
void add_membrane(const Membrane& membrane, const Vec3* x, Curvature& out);
void add_hinge(const Hinge& hinge, const Vec3* x, Curvature& out);
void add_prism(const Prism& prism, const Vec3* x, Curvature& out);
void add_tether(const Tether& tether, const Vec3& normal, Curvature& out);

}  // namespace fascia::sim
