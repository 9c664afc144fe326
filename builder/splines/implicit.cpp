#include "builder/splines/implicit.h"

#include <cmath>
#include <string>

#include "geometry/error.h"

namespace fascia::splines {
namespace {

SplineOptions spline_options(const ImplicitOptions& options) {
  SplineOptions out;
  out.dimension = options.dimension;
  out.exponent = options.exponent;
  out.degree = options.degree;
  out.lambda = options.lambda;
  return out;
}

std::vector<Vec3> unit_normals(std::span<const Vec3> points, std::span<const Vec3> normals, int dimension) {
  if (points.size() != normals.size())
    throw Error("implicit surface: " + std::to_string(points.size()) + " points but " +
                std::to_string(normals.size()) + " normals; give them in pairs");
  std::vector<Vec3> out(normals.begin(), normals.end());
  for (size_t i = 0; i < out.size(); ++i) {
    if (dimension == 2) out[i].z() = 0;
    if (!(out[i].norm() > 0) || !out[i].allFinite())
      throw Error("implicit surface: normal " + std::to_string(i) + " is zero or not finite");
    out[i].normalize();
  }
  return out;
}

}  // namespace

Spline fit_variational(std::span<const Vec3> points, std::span<const Vec3> normals,
                       const ImplicitOptions& options) {
  const std::vector<Vec3> unit = unit_normals(points, normals, options.dimension);
  Sites sites;
  sites.points.assign(points.begin(), points.end());
  const double offset = options.offset > 0 ? options.offset : 0.01 * bounds(sites.points).size().norm();
  for (size_t i = 0; i < unit.size(); ++i)
    sites.points.push_back(points[i] - offset * unit[i]);
  Eigen::MatrixXd data = Eigen::MatrixXd::Zero(sites.value_count(), 1);
  data.bottomRows(static_cast<Eigen::Index>(unit.size())).setConstant(-1);
  return fit(sites, data, spline_options(options));
}

Spline fit_hermite(std::span<const Vec3> points, std::span<const Vec3> normals,
                   const ImplicitOptions& options) {
  const std::vector<Vec3> unit = unit_normals(points, normals, options.dimension);
  Sites sites;
  sites.points.assign(points.begin(), points.end());
  for (const Vec3& point : points)
    sites.add_gradient(point, options.dimension);
  Eigen::MatrixXd data = Eigen::MatrixXd::Zero(sites.rows(), 1);
  for (int i = 0; i < sites.value_count(); ++i)
    data.block(sites.value_count() + i * options.dimension, 0, options.dimension, 1) =
        unit[static_cast<size_t>(i)].head(options.dimension);
  return fit(sites, data, spline_options(options));
}

std::optional<Vec3> trace(const Spline& field, const Vec3& origin, const Vec3& direction, double range,
                          int steps) {
  const Vec3 unit = direction.normalized();
  if (!unit.allFinite() || !(unit.norm() > 0)) throw Error("implicit surface: the ray's direction is zero");
  double near = 0, near_value = field.scalar(origin);
  if (near_value == 0) return origin;
  for (int k = 1; k <= steps; ++k) {
    double far = range * k / steps, far_value = field.scalar(origin + far * unit);
    if (std::signbit(far_value) == std::signbit(near_value) && far_value != 0) {
      near = far;
      near_value = far_value;
      continue;
    }
    // Regula falsi with bisection every other step: the bracket shrinks by half at least every two.
    for (int i = 0; i < 120 && far - near > 4e-16 * (1 + far); ++i) {
      const double share = i % 2 == 0 ? near_value / (near_value - far_value) : 0.5;
      const double middle = near + share * (far - near), value = field.scalar(origin + middle * unit);
      if (value == 0) return origin + middle * unit;
      if (std::signbit(value) == std::signbit(near_value)) {
        near = middle;
        near_value = value;
      } else {
        far = middle;
        far_value = value;
      }
    }
    return origin + 0.5 * (near + far) * unit;
  }
  return std::nullopt;
}

std::optional<Vec3> project(const Spline& field, const Vec3& point) {
  Vec3 at = point;
  const double extent = 1 / field.coefficients().scale;
  for (int i = 0; i < 50; ++i) {
    Vec3 gradient;
    const double value = field.value_and_gradient(at, gradient);
    const double squared = gradient.squaredNorm();
    if (!(squared > 0)) return std::nullopt;
    Vec3 step = value / squared * gradient;
    // A flat spot must not throw the point out of the data.
    if (step.norm() > 0.2 * extent) step *= 0.2 * extent / step.norm();
    at -= step;
    if (step.norm() < 1e-13 * extent) return at;
  }
  return std::nullopt;
}

LevelCurvature level_curvature(const Spline& field, const Vec3& point) {
  Vec3 gradient;
  field.value_and_gradient(point, gradient);
  const double length = gradient.norm();
  if (!(length > 0)) throw Error("implicit surface: no gradient where its curvature is asked for");
  const Vec3 n = gradient / length;
  const Mat3 H = field.hessian(point) / length;
  // Second fundamental form: the Hessian on the two tangents.
  LevelCurvature out;
  if (field.dimension() == 2) {
    const Vec3 t(-n.y(), n.x(), 0);
    out.mean = out.gaussian = t.dot(H * t);
    return out;
  }
  const std::array<Vec3, 2> t = tangents(n);
  const double a = t[0].dot(H * t[0]), b = t[0].dot(H * t[1]), c = t[1].dot(H * t[1]);
  out.mean = 0.5 * (a + c);
  out.gaussian = a * c - b * b;
  return out;
}

}  // namespace fascia::splines
