#include "builder/splines/rows.h"

#include <Eigen/Geometry>
#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <string>

#include "builder/splines/evaluate.h"
#include "builder/splines/simd.h"
#include "geometry/error.h"

namespace fascia::splines {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

// For each row the first one at the same point.
std::vector<int> first_at_point(std::span<const Row> rows) {
  std::vector<int> order(rows.size()), first(rows.size());
  std::iota(order.begin(), order.end(), 0);
  const auto before = [&](int i, int j) {
    const Vec3 &p = rows[i].point, &q = rows[j].point;
    for (int axis = 0; axis < 3; ++axis)
      if (p[axis] != q[axis]) return p[axis] < q[axis];
    return i < j;
  };
  std::sort(order.begin(), order.end(), before);
  for (size_t k = 0; k < order.size(); ++k) {
    const bool same = k > 0 && rows[order[k]].point == rows[order[k - 1]].point;
    first[order[k]] = same ? first[order[k - 1]] : order[k];
  }
  return first;
}

Vec3 flattened(Vec3 p, int dimension) {
  if (dimension == 2) p.z() = 0;
  return p;
}

void check_options(const Sites& sites, const SplineOptions& options) {
  if (options.dimension != 2 && options.dimension != 3)
    throw Error("spline: dimension must be 2 or 3, not " + std::to_string(options.dimension));
  if (sites.rows() == 0) throw Error("spline: no data; give at least one value");
  if (sites.derivative_directions.size() != sites.derivative_points.size())
    throw Error("spline: " + std::to_string(sites.derivative_points.size()) + " derivative points but " +
                std::to_string(sites.derivative_directions.size()) + " directions; give them in pairs");
  if (!(options.lambda >= 0) || !std::isfinite(options.lambda))
    throw Error("spline: smoothing lambda must be 0 or positive and finite");
}

void check_weights(const std::vector<double>& weights, int count, const char* what) {
  if (!weights.empty() && static_cast<int>(weights.size()) != count)
    throw Error(std::string("spline: ") + std::to_string(weights.size()) + " weights for " +
                std::to_string(count) + " " + what);
}

void check_points(const std::vector<Vec3>& points, int dimension, const char* what) {
  for (size_t i = 0; i < points.size(); ++i)
    if (!flattened(points[i], dimension).allFinite())
      throw Error(std::string("spline: ") + what + " " + std::to_string(i) + " is not finite");
}

double local_ridge(const System& system, double weight, double data_scale) {
  if (!(weight > 0)) throw Error("spline: weights must be positive (leave the datum out instead)");
  if (system.options.lambda == 0) return 0;
  return system.options.lambda * std::pow(system.scale, system.kernel.exponent()) / weight * data_scale *
         data_scale;
}

// Centroid at the origin, farthest site at distance 1: the solution does not depend on it, conditioning does.
void place(System& system, const Sites& sites) {
  std::vector<Vec3> points = sites.points;
  points.insert(points.end(), sites.derivative_points.begin(), sites.derivative_points.end());
  Vec3 centre = Vec3::Zero();
  for (const Vec3& p : points)
    centre += flattened(p, system.options.dimension) / static_cast<double>(points.size());
  double radius = 0;
  for (const Vec3& p : points)
    radius = std::max(radius, (flattened(p, system.options.dimension) - centre).norm());
  system.centre = centre;
  system.scale = radius > 0 ? 1 / radius : 1;
}

}  // namespace

void Sites::add_gradient(const Vec3& point, int dimension) {
  for (int axis = 0; axis < dimension; ++axis)
    add_derivative(point, Vec3::Unit(axis));
}

void Sites::add_derivative(const Vec3& point, const Vec3& direction) {
  derivative_points.push_back(point);
  derivative_directions.push_back(direction);
}

void Sites::add_tangents(const Vec3& point, const Vec3& normal) {
  for (const Vec3& tangent : tangents(normal))
    add_derivative(point, tangent);
}

std::array<Vec3, 2> tangents(const Vec3& normal) {
  if (!(normal.norm() > 0)) throw Error("spline: a normal is zero or not finite");
  const Vec3 n = normal.normalized();
  int least = 0;
  n.cwiseAbs().minCoeff(&least);
  const Vec3 first = n.cross(Vec3::Unit(least)).normalized();
  return {first, n.cross(first)};
}

Row System::value_row(const Vec3& point, double weight) const {
  Row row;
  row.point = (flattened(point, options.dimension) - centre) * scale;
  row.ridge = local_ridge(*this, weight, 1);
  return row;
}

Row System::derivative_row(const Vec3& point, const Vec3& direction, double weight) const {
  if (options.exponent <= 2)
    throw Error("spline: derivative data need a kernel exponent above 2, not " +
                std::to_string(options.exponent) + "; use 3");
  Row row;
  row.point = (flattened(point, options.dimension) - centre) * scale;
  row.direction = flattened(direction, options.dimension);
  if (!(row.direction.norm() > 0)) throw Error("spline: a derivative direction is zero");
  if (options.unit_directions) row.direction.normalize();
  row.derivative = true;
  row.data_scale = 1 / scale;
  row.ridge = local_ridge(*this, weight, row.data_scale);
  return row;
}

double System::entry(const Row& a, const Row& b) const {
  const Vec3 h = a.point - b.point;
  const double squared = h.squaredNorm();
  if (!a.derivative && !b.derivative) return kernel.value(squared);
  const Radial radial = kernel.radial(squared);
  if (a.derivative && !b.derivative) return radial.g * a.direction.dot(h);
  if (!a.derivative) return -radial.g * b.direction.dot(h);
  return -(radial.g * a.direction.dot(b.direction) + radial.s * a.direction.dot(h) * b.direction.dot(h));
}

VectorXd System::polynomial_row(const Row& row) const {
  VectorXd out(static_cast<Index>(monomials.size()));
  for (size_t j = 0; j < monomials.size(); ++j)
    out[static_cast<Index>(j)] = row.derivative
                                     ? monomial_gradient(monomials[j], row.point).dot(row.direction)
                                     : monomial_value(monomials[j], row.point);
  return out;
}

MatrixXd System::kernel_matrix(std::span<const Row> rows) const {
  const Index n = static_cast<Index>(rows.size());
  MatrixXd K(n, n);
  const auto derivative = [](const Row& row) { return row.derivative; };
  const int exponent = simd_exponent(kernel);
  if (exponent > 0 && std::none_of(rows.begin(), rows.end(), derivative)) {
    MatrixXd points(n, 3);
    for (Index i = 0; i < n; ++i)
      points.row(i) = rows[i].point.transpose();
    const double* x = points.data();
    const size_t count = rows.size();
    simd::functions().kernel_matrix({x, x + n, x + 2 * n, count, exponent, kernel.sign(), K.data(), count});
  } else {
    for (Index j = 0; j < n; ++j)
      for (Index i = j; i < n; ++i)
        K(i, j) = entry(rows[i], rows[j]);
  }
  for (Index j = 0; j < n; ++j)
    K(j, j) += rows[j].ridge;
  return K;
}

MatrixXd System::polynomial_matrix(std::span<const Row> rows) const {
  MatrixXd P(static_cast<Index>(rows.size()), static_cast<Index>(monomials.size()));
  for (size_t i = 0; i < rows.size(); ++i)
    P.row(static_cast<Index>(i)) = polynomial_row(rows[i]).transpose();
  return P;
}

double System::energy_scale() const {
  return std::pow(scale, kernel.exponent());
}

System make_system(const Sites& sites, const SplineOptions& options) {
  check_options(sites, options);
  check_points(sites.points, options.dimension, "point");
  check_points(sites.derivative_points, options.dimension, "derivative point");
  check_points(sites.derivative_directions, options.dimension, "derivative direction");
  System system;
  system.options = options;
  system.kernel = Kernel(options.exponent);
  if (options.degree < 0) system.options.degree = std::max(1, system.kernel.required_degree());
  system.definite = system.options.degree >= system.kernel.required_degree();
  system.monomials = monomials(options.dimension, system.options.degree);
  // Without the matching null space the solution depends on the unit: keep the user's.
  if (system.definite) place(system, sites);
  return system;
}

std::vector<Row> make_rows(const System& system, const Sites& sites) {
  check_weights(sites.weights, sites.value_count(), "values");
  check_weights(sites.derivative_weights, sites.derivative_count(), "derivatives");
  std::vector<Row> rows;
  rows.reserve(static_cast<size_t>(sites.rows()));
  for (int i = 0; i < sites.value_count(); ++i)
    rows.push_back(system.value_row(sites.points[i], sites.weights.empty() ? 1 : sites.weights[i]));
  for (int j = 0; j < sites.derivative_count(); ++j)
    rows.push_back(system.derivative_row(sites.derivative_points[j], sites.derivative_directions[j],
                                         sites.derivative_weights.empty() ? 1 : sites.derivative_weights[j]));
  check_duplicates(rows, system.options.dimension);
  return rows;
}

// Two values at one point contradict each other or say the same twice: both leave the system singular.
void check_duplicates(std::span<const Row> rows, int dimension) {
  const std::vector<int> first = first_at_point(rows);
  std::vector<int> value_at(rows.size(), -1);
  std::map<int, std::vector<int>> groups;
  for (size_t i = 0; i < rows.size(); ++i) {
    if (rows[i].ridge > 0) continue;
    if (rows[i].derivative) {
      groups[first[i]].push_back(static_cast<int>(i));
      continue;
    }
    int& other = value_at[first[i]];
    if (other >= 0)
      throw Error("spline: data " + std::to_string(other) + " and " + std::to_string(i) +
                  " are at the same point, where they repeat or contradict each other; merge them or smooth "
                  "(lambda > 0)");
    other = static_cast<int>(i);
  }
  for (const auto& [place, members] : groups) {
    MatrixXd directions(dimension, static_cast<Index>(members.size()));
    for (size_t k = 0; k < members.size(); ++k)
      directions.col(static_cast<Index>(k)) = rows[members[k]].direction.normalized().head(dimension);
    Eigen::ColPivHouseholderQR<MatrixXd> qr(directions);
    qr.setThreshold(1e-9);
    if (qr.rank() < directions.cols())
      throw Error("spline: " + std::to_string(members.size()) + " derivative data at the point of datum " +
                  std::to_string(members.front()) +
                  " have dependent directions; drop one or smooth (lambda > 0)");
  }
}

MatrixXd local_data(std::span<const Row> rows, const MatrixXd& data) {
  if (data.rows() != static_cast<Index>(rows.size()))
    throw Error("spline: " + std::to_string(data.rows()) + " data for " + std::to_string(rows.size()) +
                " sites");
  if (!data.allFinite()) throw Error("spline: data contain a value that is not finite");
  MatrixXd out = data;
  for (size_t i = 0; i < rows.size(); ++i)
    out.row(static_cast<Index>(i)) *= rows[i].data_scale;
  return out;
}

Spline make_spline(const System& system, std::span<const Row> rows, const MatrixXd& data, const MatrixXd& c,
                   const MatrixXd& a) {
  SplineCoefficients out;
  out.kernel = system.kernel;
  out.dimension = system.options.dimension;
  out.outputs = static_cast<int>(data.cols());
  out.degree = system.options.degree;
  out.centre = system.centre;
  out.scale = system.scale;
  out.monomials = system.monomials;
  out.polynomial = a;

  // Rows at one place become one centre.
  const std::vector<int> first = first_at_point(rows);
  std::vector<int> centre_of(rows.size());
  std::vector<Vec3> centres;
  bool derivatives = false;
  for (size_t i = 0; i < rows.size(); ++i) {
    const bool fresh = first[i] == static_cast<int>(i);
    centre_of[i] = fresh ? static_cast<int>(centres.size()) : centre_of[first[i]];
    if (fresh) centres.push_back(rows[i].point);
    derivatives |= rows[i].derivative;
    // c^T K c = c^T (y - P a) - c^T ridge c, and c is orthogonal to P.
    const Index r = static_cast<Index>(i);
    out.energy += c.row(r).dot(data.row(r)) - rows[i].ridge * c.row(r).squaredNorm();
  }
  out.energy *= system.energy_scale();
  out.centres = static_cast<int>(centres.size());
  out.stride = (out.centres + 7) / 8 * 8;
  const size_t stride = static_cast<size_t>(out.stride), total = stride * out.outputs;
  for (auto* array : {&out.x, &out.y, &out.z})
    array->assign(stride, 0);
  for (size_t i = 0; i < centres.size(); ++i) {
    out.x[i] = centres[i].x();
    out.y[i] = centres[i].y();
    out.z[i] = centres[i].z();
  }
  out.c.assign(total, 0);
  if (derivatives)
    for (auto* array : {&out.bx, &out.by, &out.bz})
      array->assign(total, 0);
  for (int k = 0; k < out.outputs; ++k)
    for (size_t i = 0; i < rows.size(); ++i) {
      const size_t at = k * stride + centre_of[i];
      const double weight = c(static_cast<Index>(i), k);
      if (!rows[i].derivative) {
        out.c[at] += weight;
        continue;
      }
      out.bx[at] += weight * rows[i].direction.x();
      out.by[at] += weight * rows[i].direction.y();
      out.bz[at] += weight * rows[i].direction.z();
    }
  return Spline(std::move(out));
}

void throw_singular(const System& system, std::span<const Row> rows) {
  if (!system.definite)
    throw Error("spline: the data do not determine a polynomial of degree " +
                std::to_string(system.options.degree) + " with this kernel; use degree -1");
  double least = std::numeric_limits<double>::infinity();
  size_t first = 0, second = 0;
  for (size_t i = 0; i < rows.size(); ++i)
    for (size_t j = 0; j < i; ++j) {
      const double distance = (rows[i].point - rows[j].point).norm();
      if (rows[i].derivative != rows[j].derivative || distance == 0 || distance >= least) continue;
      least = distance;
      first = j;
      second = i;
    }
  throw Error("spline: the fit is numerically singular; data " + std::to_string(first) + " and " +
              std::to_string(second) + " are only " + std::to_string(least) +
              " of the whole extent apart; merge near duplicates or smooth (lambda > 0)");
}

}  // namespace fascia::splines
