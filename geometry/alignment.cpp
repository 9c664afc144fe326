#include "geometry/alignment.h"

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

namespace fascia {

namespace {

Vec3 mean_of(std::span<const Vec3> points) {
  Vec3 mean = Vec3::Zero();
  for (const Vec3& p : points)
    mean += p / static_cast<double>(points.size());
  return mean;
}

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

Mat4 rigid_motion(std::span<const Vec3> source, std::span<const Vec3> target,
                  std::span<const double> weights) {
  return align(source, target, weights, false);
}

Mat3 nearest_rotation(const Mat3& correlation) {
  const Eigen::JacobiSVD<Mat3> svd(correlation, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Vec3 signs = Vec3::Ones();
  if (svd.matrixU().determinant() * svd.matrixV().determinant() < 0) signs.z() = -1;
  return svd.matrixU() * signs.asDiagonal() * svd.matrixV().transpose();
}

Eigen::Quaterniond least_rotation(const Vec3& from, const Vec3& to) {
  return Eigen::Quaterniond::FromTwoVectors(from, to);
}

Eigen::Quaternionf least_rotation(const Eigen::Vector3f& from, const Eigen::Vector3f& to) {
  return Eigen::Quaternionf::FromTwoVectors(from, to);
}

PrincipalAxes principal_axes(const Mat3& symmetric) {
  const Eigen::SelfAdjointEigenSolver<Mat3> solver(symmetric);
  return {solver.eigenvalues(), solver.eigenvectors()};
}

Mat3 scatter(std::span<const Vec3> points) {
  const Vec3 mean = mean_of(points);
  Mat3 sum = Mat3::Zero();
  for (const Vec3& p : points)
    sum += (p - mean) * (p - mean).transpose();
  return sum;
}

Sphere least_squares_sphere(std::span<const Vec3> points) {
  Sphere sphere;
  if (points.size() < 4) return sphere;
  // |p|^2 = 2 c.p + (r^2 - |c|^2) is linear in c and the bracket; centred for conditioning.
  const Vec3 mean = mean_of(points);
  Eigen::MatrixX4d rows(points.size(), 4);
  Eigen::VectorXd squares(points.size());
  for (size_t i = 0; i < points.size(); ++i) {
    const Vec3 p = points[i] - mean;
    rows.row(static_cast<Eigen::Index>(i)) << 2 * p[0], 2 * p[1], 2 * p[2], 1.0;
    squares[static_cast<Eigen::Index>(i)] = p.squaredNorm();
  }
  const Eigen::Vector4d solution = rows.colPivHouseholderQr().solve(squares);
  sphere.centre = solution.head<3>() + mean;
  sphere.radius = std::sqrt(std::max(0.0, solution[3] + solution.head<3>().squaredNorm()));
  return sphere;
}

double distance_rms(const Sphere& sphere, std::span<const Vec3> points) {
  double sum = 0.0;
  for (const Vec3& p : points)
    sum += std::pow((p - sphere.centre).norm() - sphere.radius, 2);
  return points.empty() ? 0.0 : std::sqrt(sum / static_cast<double>(points.size()));
}

}  // namespace fascia
