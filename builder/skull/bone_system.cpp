#include "builder/skull/bone_system.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <cmath>

namespace fascia::skull {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

// A direction in which an observation's target may move.
struct Slide {
  Index row = 0;
  Vec3 direction = Vec3::Zero();
  double hold = 0;  // 1 / variance, in units of the bending form
};

void add_slides(const Observation& observation, Index row, double smoothing, std::vector<Slide>& out) {
  if (!observation.used) {
    for (int axis = 0; axis < 3; ++axis)
      out.push_back({row, Vec3::Unit(axis), 0});
    return;
  }
  if (observation.normal.isZero() || !(observation.slide_sd > 0) || !(smoothing > 0)) return;
  const Vec3 u = observation.normal.unitOrthogonal(), v = observation.normal.cross(u);
  const double hold = 1 / (smoothing * observation.slide_sd * observation.slide_sd);
  out.push_back({row, u, hold});
  out.push_back({row, v, hold});
}

}  // namespace

BoneSystem::BoneSystem(std::span<const Observation> observations,
                       std::span<const TangentObservation> tangents, double smoothing, double exponent) {
  for (const Observation& observation : observations) {
    sites_.points.push_back(observation.from);
    sites_.weights.push_back(1 / (observation.sd * observation.sd));
  }
  for (const TangentObservation& tangent : tangents) {
    sites_.derivative_points.push_back(tangent.at);
    sites_.derivative_directions.push_back(tangent.tangent);
    sites_.derivative_weights.push_back(1 / (tangent.sd * tangent.sd));
  }
  values_ = static_cast<int>(observations.size());
  options_.exponent = exponent;
  options_.lambda = smoothing;
  factorisation_ = std::make_shared<const splines::Factorisation>(sites_, options_);
  bending_ =
      factorisation_->coefficients(MatrixXd::Identity(sites_.rows(), sites_.rows())).topRows(sites_.rows());
}

MatrixXd BoneSystem::displacements(std::span<const Observation> observations,
                                   std::span<const TangentObservation> tangents) const {
  MatrixXd data(sites_.rows(), 3);
  std::vector<Slide> slides;
  for (size_t i = 0; i < observations.size(); ++i) {
    const Index row = static_cast<Index>(i);
    data.row(row) =
        (observations[i].used ? Vec3(observations[i].to - observations[i].from) : Vec3(Vec3::Zero()))
            .transpose();
    add_slides(observations[i], row, options_.lambda, slides);
  }
  for (size_t i = 0; i < tangents.size(); ++i)
    data.row(values_ + static_cast<Index>(i)) = (tangents[i].target - tangents[i].tangent).transpose();
  if (slides.empty()) return data;

  // (U^T B U + hold) t = -U^T B y
  const Index count = static_cast<Index>(slides.size());
  const MatrixXd pull = bending_ * data;
  MatrixXd form(count, count);
  Eigen::VectorXd right(count);
  for (Index i = 0; i < count; ++i) {
    const Slide& a = slides[static_cast<size_t>(i)];
    right[i] = -pull.row(a.row).dot(a.direction);
    for (Index j = 0; j <= i; ++j) {
      const Slide& b = slides[static_cast<size_t>(j)];
      form(i, j) = bending_(a.row, b.row) * a.direction.dot(b.direction);
    }
    form(i, i) += a.hold;
  }
  const Eigen::LLT<MatrixXd> factor(form);
  const Eigen::VectorXd way = factor.info() == Eigen::Success
                                  ? Eigen::VectorXd(factor.solve(right))
                                  : Eigen::VectorXd(form.selfadjointView<Eigen::Lower>().ldlt().solve(right));
  for (Index i = 0; i < count; ++i)
    data.row(slides[static_cast<size_t>(i)].row) +=
        way[i] * slides[static_cast<size_t>(i)].direction.transpose();
  return data;
}

splines::Warp BoneSystem::warp(const MatrixXd& displacements) const {
  return splines::Warp(factorisation_->solve(displacements));
}

void BoneSystem::prepare(std::span<const Vec3> points) {
  points_.assign(points.begin(), points.end());
  const splines::Spline spline = factorisation_->solve(MatrixXd::Zero(sites_.rows(), 3));
  const splines::SplineCoefficients& all = spline.coefficients();
  basis_.resize(all.centres, static_cast<Index>(points.size()));
  for (Index v = 0; v < basis_.cols(); ++v) {
    const Vec3 q = (points_[static_cast<size_t>(v)] - all.centre) * all.scale;
    for (Index i = 0; i < basis_.rows(); ++i) {
      const auto at = static_cast<size_t>(i);
      const double squared = (q - Vec3(all.x[at], all.y[at], all.z[at])).squaredNorm();
      basis_(i, v) =
          all.kernel.exponent() == 1 ? all.kernel.sign() * std::sqrt(squared) : all.kernel.value(squared);
    }
  }
}

std::vector<Vec3> BoneSystem::positions(const splines::Warp& warp) const {
  const splines::SplineCoefficients& all = warp.displacement().coefficients();
  // Derivative data bring terms that the basis does not hold.
  if (!all.bx.empty() || basis_.rows() != all.centres) return warp(std::span<const Vec3>(points_));
  Eigen::Matrix<double, 3, Eigen::Dynamic> coefficients(3, all.centres);
  for (Index k = 0; k < 3; ++k)
    coefficients.row(k) = Eigen::Map<const Eigen::RowVectorXd>(all.c.data() + k * all.stride, all.centres);
  std::vector<Vec3> out(points_.size());
  for (size_t v = 0; v < out.size(); ++v) {
    const Vec3 q = (points_[v] - all.centre) * all.scale;
    Vec3 moved = coefficients * basis_.col(static_cast<Index>(v));
    for (size_t k = 0; k < all.monomials.size(); ++k)
      moved += splines::monomial_value(all.monomials[k], q) *
               all.polynomial.row(static_cast<Index>(k)).transpose();
    out[v] = points_[v] + moved;
  }
  return out;
}

}  // namespace fascia::skull
