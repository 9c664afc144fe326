#include "builder/splines/warp.h"

#include <string>

#include "geometry/error.h"

namespace fascia::splines {

Warp::Warp(Spline displacement) : displacement_(std::move(displacement)), identity_(false) {
  if (displacement_.outputs() != displacement_.dimension())
    throw Error("warp: the displacement must be a spline from space to 3 numbers or from the plane to 2");
}

Vec3 Warp::operator()(const Vec3& point) const {
  if (identity_) return point;
  Vec3 shift = Vec3::Zero();
  displacement_.evaluate(point, shift.data());
  return point + shift;
}

std::vector<Vec3> Warp::operator()(std::span<const Vec3> points) const {
  std::vector<Vec3> out(points.begin(), points.end());
  if (identity_) return out;
  const Eigen::MatrixXd shift = displacement_.values(points);
  for (size_t i = 0; i < out.size(); ++i)
    out[i].head(shift.cols()) += shift.row(static_cast<Eigen::Index>(i)).transpose();
  return out;
}

TriangleMesh Warp::operator()(const TriangleMesh& mesh) const {
  return {(*this)(std::span<const Vec3>(mesh.vertices)), mesh.triangles};
}

Mat3 Warp::jacobian(const Vec3& point) const {
  if (identity_) return Mat3::Identity();
  Mat3 out = Mat3::Identity();
  out.topRows(displacement_.outputs()) += displacement_.jacobian(point);
  return out;
}

Warp fit_warp(std::span<const Vec3> source, std::span<const Vec3> target, const WarpOptions& options) {
  if (source.size() != target.size())
    throw Error("warp: " + std::to_string(source.size()) + " source landmarks but " +
                std::to_string(target.size()) + " target landmarks; give them in pairs");
  Sites sites;
  sites.points.assign(source.begin(), source.end());
  sites.weights = options.weights;
  SplineOptions spline;
  spline.dimension = options.dimension;
  spline.exponent = options.exponent;
  spline.lambda = options.lambda;
  Eigen::MatrixXd shift(sites.value_count(), options.dimension);
  for (int i = 0; i < sites.value_count(); ++i)
    shift.row(i) = (target[i] - source[i]).head(options.dimension).transpose();
  return Warp(fit(sites, shift, spline));
}

}  // namespace fascia::splines
