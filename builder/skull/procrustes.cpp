#include "builder/skull/procrustes.h"

#include <Eigen/LU>
#include <Eigen/SVD>

namespace fascia::skull {
namespace {

Mat4 align(std::span<const Vec3> source, std::span<const Vec3> target, std::span<const double> weights,
           bool scaled) {
  const auto weight = [&](size_t i) { return weights.empty() ? 1.0 : weights[i]; };
  Mat4 out = Mat4::Identity();
  Vec3 from = Vec3::Zero(), to = Vec3::Zero();
  double total = 0;
  for (size_t i = 0; i < source.size(); ++i) {
    from += weight(i) * source[i];
    to += weight(i) * target[i];
    total += weight(i);
  }
  if (!(total > 0)) return out;
  from /= total;
  to /= total;
  Mat3 covariance = Mat3::Zero();
  double spread = 0;
  for (size_t i = 0; i < source.size(); ++i) {
    covariance += weight(i) * (target[i] - to) * (source[i] - from).transpose();
    spread += weight(i) * (source[i] - from).squaredNorm();
  }
  Eigen::JacobiSVD<Mat3> svd(covariance, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Vec3 signs = Vec3::Ones();
  if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0) signs.z() = -1;
  Mat3 rotation = svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
  double scale = 1;
  const bool turns = spread > 0 && svd.singularValues()[0] > 0;
  if (!turns) rotation.setIdentity();
  if (turns && scaled) scale = svd.singularValues().dot(signs) / spread;
  if (!(scale > 0)) scale = 1;
  out.topLeftCorner<3, 3>() = scale * rotation;
  out.topRightCorner<3, 1>() = to - scale * rotation * from;
  return out;
}

}  // namespace

Mat4 similarity(std::span<const Vec3> source, std::span<const Vec3> target, std::span<const double> weights) {
  return align(source, target, weights, true);
}

Mat4 rigid(std::span<const Vec3> source, std::span<const Vec3> target, std::span<const double> weights) {
  return align(source, target, weights, false);
}

}  // namespace fascia::skull
