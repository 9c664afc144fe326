#pragma once

#include <Eigen/SparseCholesky>
#include <Eigen/SparseCore>
#include <vector>

#include "geometry/mesh.h"

namespace fascia::tissue {

/// Each vertex's third of the area of the triangles around it, square metres.
std::vector<double> vertex_areas(const TriangleMesh& mesh);

/// The cotangent Laplacian of `mesh`, positive semidefinite, each edge's weight times the product of its
/// ends' `lengths` (metres). Cotangents are kept between -1 and 10: slivers weigh no more than that.
Eigen::SparseMatrix<double> laplacian(const TriangleMesh& mesh, const std::vector<double>& lengths);

/// Smooths functions on a surface over about `lengths` (#vertices, metres) by one implicit step of diffusion,
/// nearly independent of the triangulation.
class SurfaceSmoother {
 public:
  SurfaceSmoother(const TriangleMesh& mesh, const std::vector<double>& lengths);
  void smooth(std::vector<double>& values) const;
  void smooth(std::vector<Vec3>& values) const;
  void smooth(Eigen::MatrixXd& values) const;  ///< one function per column

 private:
  std::vector<double> areas_;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver_;
};

}  // namespace fascia::tissue
