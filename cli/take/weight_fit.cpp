#include "cli/take/weight_fit.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "cli/take/largest_length.h"
#include "cli/take/product.h"

namespace fascia::cli {

namespace {

using Eigen::Index;
using Eigen::MatrixXf;
using Eigen::VectorXf;

constexpr Index frames_of_a_block = 32;

/// The rows of the vertices `which` of one column.
void copy_rows(const float* from, const std::vector<Index>& which, float* to) {
  for (const Index v : which)
    to = std::copy_n(from + 3 * v, 3, to);
}

}  // namespace

WeightFit::WeightFit(std::vector<uint32_t> vertices, Components components, const Options& options)
    : vertices_(std::move(vertices)), components_(std::move(components)), options_(options) {
  block_.resize(static_cast<Index>(3 * vertices_.size()), frames_of_a_block);
  shapes_ = std::move(components_.shapes);
  given_ = static_cast<Index>(shapes_.size());
  if (given_ == 0) return;
  roots_.resize(3 * components_.vertex_weights.size());
  for (Index v = 0; v < components_.vertex_weights.size(); ++v)
    roots_.segment<3>(3 * v).setConstant(std::sqrt(components_.vertex_weights[v]));
  judged_shapes_.resize(roots_.size(), given_);
  for (Index k = 0; k < given_; ++k)
    copy_rows(shapes_[static_cast<size_t>(k)].data(), components_.judged, judged_shapes_.col(k).data());
  if (options_.more_shapes == 0) frame_fit_ = std::make_unique<FrameFit>(judged_shapes_);
  judged_shapes_ = roots_.asDiagonal() * judged_shapes_;
  gram_.compute((judged_shapes_.transpose() * judged_shapes_).cast<double>());
}

void WeightFit::add(std::span<const float> displacement) {
  for (size_t i = 0; i < vertices_.size(); ++i)
    for (size_t axis = 0; axis < 3; ++axis)
      block_(static_cast<Index>(3 * i + axis), waiting_) = displacement[3 * vertices_[i] + axis];
  if (++waiting_ == frames_of_a_block) take_block();
}

MatrixXf WeightFit::weights_of(const MatrixXf& frames) const {
  MatrixXf judged(roots_.size(), frames.cols());
  for (Index f = 0; f < frames.cols(); ++f)
    copy_rows(frames.col(f).data(), components_.judged, judged.col(f).data());
  MatrixXf weights =
      gram_.solve((judged_shapes_.transpose() * (roots_.asDiagonal() * judged)).cast<double>()).cast<float>();
  if (!frame_fit_) return weights;
  // Thresholds do not depend on the frames before, so that the motion stays smooth.
  const auto largest = static_cast<float>(std::max(components_.sampled_error, options_.tolerance));
  const VectorXf unweighted = roots_.cwiseInverse();
  tbb::parallel_for(Index{0}, frames.cols(), [&](Index f) {
    const VectorXf off = judged.col(f) - unweighted.asDiagonal() * VectorXf(judged_shapes_ * weights.col(f));
    frame_fit_->improve(off, 0.5F * largest, 0.75F * largest, weights.col(f));
  });
  return weights;
}

/// Takes off `frames` what the shapes from `first` on make with `weights`, piece by piece.
void WeightFit::take_off(Index first, const MatrixXf& weights, MatrixXf& frames) const {
  if (weights.rows() == 0) return;
  constexpr Index rows = 3 * 1024;
  tbb::parallel_for(Index{0}, (frames.rows() + rows - 1) / rows, [&](Index piece) {
    const Index row = piece * rows, here = std::min(rows, frames.rows() - row);
    std::vector<const float*> columns;
    for (Index k = 0; k < weights.rows(); ++k)
      columns.push_back(shapes_[static_cast<size_t>(first + k)].data() + row);
    MatrixXf made;
    product(columns, here, weights, made);
    frames.middleRows(row, here) -= made;
  });
}

void WeightFit::take_block() {
  MatrixXf left = block_.leftCols(waiting_);
  const auto known = static_cast<Index>(shapes_.size());
  MatrixXf weights(known, waiting_);
  if (given_ > 0) {
    weights.topRows(given_) = weights_of(left);
    take_off(0, weights.topRows(given_), left);
  }
  tbb::parallel_for(given_, known,
                    [&](Index k) { weights.row(k) = shapes_[static_cast<size_t>(k)].transpose() * left; });
  take_off(given_, weights.bottomRows(known - given_), left);
  taken_.push_back(std::move(weights));
  add_shapes(left);
  for (Index f = 0; f < waiting_; ++f)
    left_.push_back(largest_length(left.col(f)));
  waiting_ = 0;
}

/// Makes shapes of what is left of the block's worst frames until none is off by more than the tolerance.
void WeightFit::add_shapes(MatrixXf& left) {
  while (shapes_.size() < static_cast<size_t>(given_) + options_.more_shapes) {
    VectorXf largest(left.cols());
    for (Index f = 0; f < left.cols(); ++f)
      largest[f] = largest_length(left.col(f));
    Index worst = 0;
    if (!(static_cast<double>(largest.maxCoeff(&worst)) > options_.tolerance)) return;
    VectorXf direction = left.col(worst);
    for (size_t k = static_cast<size_t>(given_); k < shapes_.size(); ++k)
      direction -= shapes_[k] * shapes_[k].dot(direction);  // rounding leaves it not quite orthogonal
    const float length = direction.norm();
    if (!(length > 0.0F)) return;
    direction /= length;
    const Eigen::RowVectorXf weights = direction.transpose() * left;
    left.noalias() -= direction * weights;
    shapes_.push_back(std::move(direction));
    MatrixXf& taken = taken_.back();
    taken.conservativeResize(taken.rows() + 1, Eigen::NoChange);
    taken.bottomRows<1>() = weights;
  }
}

WeightFit::Result WeightFit::finish() {
  if (waiting_ > 0) take_block();
  Result result;
  result.shapes = std::move(shapes_);
  result.left = std::move(left_);
  block_ = judged_shapes_ = {};
  result.weights.setZero(static_cast<Index>(result.shapes.size()), static_cast<Index>(result.left.size()));
  Index first = 0;
  for (MatrixXf& block : taken_) {
    result.weights.block(0, first, block.rows(), block.cols()) = block;
    first += block.cols();
    block = {};
  }
  // Weights of at most 1, so that a slider in a viewer means something.
  for (Index k = 0; k < result.weights.rows(); ++k) {
    const float peak = result.weights.row(k).cwiseAbs().maxCoeff();
    if (!(peak > 0.0F)) continue;
    result.weights.row(k) /= peak;
    result.shapes[static_cast<size_t>(k)] *= peak;
  }
  return result;
}

}  // namespace fascia::cli
