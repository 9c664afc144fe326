#include "builder/splines/deformation.h"

#include <string>

#include "builder/splines/sliding.h"
#include "geometry/error.h"

namespace fascia::splines {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

struct Rows {
  Sites sites;
  std::vector<Vec3> values, derivatives;
  std::vector<Freedom> freedoms;  // rows count from the first derivative
};

void add_derivative(Rows& rows, const DeformationLandmark& landmark, const Vec3& vector, const Vec3& image) {
  rows.sites.add_derivative(landmark.source, vector);
  rows.sites.derivative_weights.push_back(landmark.derivative_weight);
  rows.derivatives.push_back(image - vector);
}

std::vector<Vec3> tangent_basis(const Vec3& normal, int dimension) {
  if (dimension == 2) {
    const Vec3 tangent(-normal.y(), normal.x(), 0);
    if (!(tangent.norm() > 0)) throw Error("deformation: a normal in the plane is zero or not finite");
    return {tangent.normalized()};
  }
  const std::array<Vec3, 2> both = tangents(normal);
  return {both[0], both[1]};
}

// The images of the tangents start at zero and are free in the target's tangent plane.
void add_normal(Rows& rows, const DeformationLandmark& landmark, int dimension) {
  const std::vector<Vec3> free = tangent_basis(landmark.normal->target, dimension);
  for (const Vec3& tangent : tangent_basis(landmark.normal->source, dimension)) {
    for (const Vec3& direction : free)
      rows.freedoms.push_back({static_cast<int>(rows.derivatives.size()), direction});
    add_derivative(rows, landmark, tangent, Vec3::Zero());
  }
}

Rows make_rows(std::span<const DeformationLandmark> landmarks, int dimension) {
  Rows rows;
  for (const DeformationLandmark& landmark : landmarks) {
    rows.sites.points.push_back(landmark.source);
    rows.sites.weights.push_back(landmark.weight);
    rows.values.push_back(landmark.target - landmark.source);
    for (const CarriedVector& carried : landmark.vectors)
      add_derivative(rows, landmark, carried.vector, carried.image);
    if (landmark.normal) add_normal(rows, landmark, dimension);
  }
  return rows;
}

}  // namespace

void DeformationLandmark::carry_frame(const Mat3& jacobian, int dimension) {
  for (int axis = 0; axis < dimension; ++axis)
    vectors.push_back({Vec3::Unit(axis), jacobian.col(axis)});
}

Warp fit_deformation(std::span<const DeformationLandmark> landmarks, const DeformationOptions& options) {
  Rows rows = make_rows(landmarks, options.dimension);
  SplineOptions spline;
  spline.dimension = options.dimension;
  spline.exponent = options.exponent;
  spline.degree = options.degree;
  spline.lambda = options.lambda;
  const Factorisation factorisation(rows.sites, spline);
  const int values = rows.sites.value_count();
  MatrixXd data(rows.sites.rows(), options.dimension);
  for (int i = 0; i < rows.sites.rows(); ++i) {
    const Vec3& datum =
        i < values ? rows.values[static_cast<size_t>(i)] : rows.derivatives[static_cast<size_t>(i - values)];
    data.row(i) = datum.head(options.dimension).transpose();
  }
  if (!rows.freedoms.empty()) {
    for (Freedom& freedom : rows.freedoms)
      freedom.row += values;
    data = relax(factorisation.bending_matrix(), data, rows.freedoms).data;
  }
  return Warp(factorisation.solve(data));
}

}  // namespace fascia::splines
