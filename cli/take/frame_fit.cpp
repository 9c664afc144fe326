#include "cli/take/frame_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "cli/take/largest_length.h"
#include "geometry/smoothstep.h"

namespace fascia::cli {

namespace {

using Eigen::Index;
using Eigen::MatrixXf;
using Eigen::VectorXf;

constexpr int rounds = 6;
constexpr float norm = 10.0F, over_relaxation = 1.5F, floor = 1e-3F;

}  // namespace

FrameFit::FrameFit(MatrixXf shapes) : shapes_(std::move(shapes)), gram_(shapes_.transpose() * shapes_) {}

void FrameFit::improve(VectorXf off, float small, float large, Eigen::Ref<VectorXf> weights) const {
  float least = largest_length(off);
  const float share = std::clamp((least - small) / (large - small), 0.0F, 1.0F);
  if (!(share > 0.0F)) return;
  const VectorXf start = weights;
  VectorXf now = start, best = start;
  for (int round = 0; round < rounds; ++round) {
    const float most = largest_length(off);
    if (!(most > 0.0F)) break;
    MatrixXf matrix = floor * gram_;
    VectorXf force = floor * (gram_ * (start - now));
    for (Index v = 0; 3 * v < off.size(); ++v) {
      const float length = off.segment<3>(3 * v).norm() / most;
      if (length < 0.4F) continue;  // to the eighth power it is nothing
      const auto rows = shapes_.middleRows<3>(3 * v);
      const float weight = std::pow(length, norm - 2.0F);
      matrix.selfadjointView<Eigen::Lower>().rankUpdate(rows.transpose(), weight);
      force.noalias() += weight * (rows.transpose() * off.segment<3>(3 * v));
    }
    const VectorXf step = (over_relaxation / (norm - 1.0F)) * matrix.llt().solve(force);
    if (!step.allFinite()) break;
    now += step;
    off.noalias() -= shapes_ * step;
    if (const float error = largest_length(off); error < least) {
      least = error;
      best = now;
    }
  }
  weights = start + smoothstep(share) * (best - start);
}

}  // namespace fascia::cli
