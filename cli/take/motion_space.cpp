#include "cli/take/motion_space.h"

#include <tbb/parallel_for.h>

#include <Eigen/Eigenvalues>
#include <algorithm>

namespace fascia::cli {

namespace {

using Eigen::Index;

constexpr size_t block_frames = 32;

/// The largest length of the 3-vectors in a column.
float largest_length(const Eigen::Ref<const Eigen::VectorXf>& column) {
  float most = 0.0F;
  for (Index i = 0; i + 2 < column.size(); i += 3)
    most = std::max(most, column.segment<3>(i).squaredNorm());
  return std::sqrt(most);
}

}  // namespace

MotionSpace::MotionSpace(size_t vertices, const Options& options)
    : options_(options), vertex_count_(vertices), moves_(vertices) {
  const size_t room = options.most_bytes / std::max<size_t>(1, 12 * vertices);
  options_.most_directions = std::min(std::max<size_t>(room, 128), options.most_directions);
}

void MotionSpace::add(std::span<const float> displacement) {
  if (block_.size() <= waiting_) block_.emplace_back();
  block_[waiting_++].assign(displacement.begin(), displacement.end());
  ++frames_;
  if (waiting_ == block_frames) take_block();
}

void MotionSpace::finish() {
  if (waiting_ > 0) take_block();
  coefficients_.conservativeResize(static_cast<Index>(directions_.size()), static_cast<Index>(frames_));
  block_.clear();
  block_.shrink_to_fit();
}

void MotionSpace::find_moving() {
  const size_t before = moving_.size();
  for (size_t f = 0; f < waiting_; ++f) {
    const float* frame = block_[f].data();
    for (size_t v = 0; v < vertex_count_; ++v) {
      if (moves_[v] || (frame[3 * v] == 0.0F && frame[3 * v + 1] == 0.0F && frame[3 * v + 2] == 0.0F))
        continue;
      moves_[v] = 1;
      moving_.push_back(static_cast<uint32_t>(v));
    }
  }
  if (moving_.empty()) return;
  // The skin moves as one body: what moves first is nearly all that ever does.
  if (stride_ == 0)
    stride_ = std::max<size_t>(1, moving_.size() / std::max<size_t>(1, options_.sampled_vertices));
  for (size_t i = before; i < moving_.size(); ++i)
    if (i % stride_ == 0) sampled_.push_back(moving_[i]);
}

void MotionSpace::take_block() {
  find_moving();
  const auto rows = static_cast<Index>(3 * sampled_.size()), count = static_cast<Index>(waiting_);
  if (sampled_directions_.rows() < rows) {
    const Index before = sampled_directions_.rows();
    sampled_directions_.conservativeResize(rows, sampled_directions_.cols());
    sampled_directions_.bottomRows(rows - before).setZero();  // they did not move yet
  }
  sampled_frames_.resize(rows, count);
  for (Index f = 0; f < count; ++f)
    for (size_t s = 0; s < sampled_.size(); ++s)
      for (size_t axis = 0; axis < 3; ++axis)
        sampled_frames_(static_cast<Index>(3 * s + axis), f) =
            block_[static_cast<size_t>(f)][3 * sampled_[s] + axis];
  const auto first = static_cast<Index>(frames_ - waiting_);
  auto known = static_cast<Index>(directions_.size());
  if (coefficients_.cols() < first + count || coefficients_.rows() < known) {
    const Index before = coefficients_.cols(), rows_before = coefficients_.rows();
    coefficients_.conservativeResize(std::max<Index>(rows_before, known + 16),
                                     std::max<Index>(before, 2 * (first + count)));
    coefficients_.rightCols(coefficients_.cols() - before).setZero();
    coefficients_.bottomRows(coefficients_.rows() - rows_before).setZero();
  }
  const auto used = sampled_directions_.leftCols(known);
  coefficients_.block(0, first, known, count).noalias() = used.transpose() * sampled_frames_;
  sampled_left_ = sampled_frames_;
  sampled_left_.noalias() -= used * coefficients_.block(0, first, known, count);
  // What single precision leaves of a frame is noise: a direction made of it would be wrong everywhere.
  float largest = 0.0F;
  for (Index f = 0; f < count; ++f)
    largest = std::max(largest, largest_length(sampled_frames_.col(f)));
  const double noise = 1e-5 * largest;
  while (true) {
    Index worst = 0;
    float most = 0.0F;
    for (Index f = 0; f < count; ++f)
      if (const float left = largest_length(sampled_left_.col(f)); left > most) {
        most = left;
        worst = f;
      }
    if (!(most > std::max(options_.tolerance, noise))) break;
    if (directions_.size() >= options_.most_directions) give_up_the_least();
    extend(worst);
  }
  if (is_whole_) measure_block();
  waiting_ = 0;
}

/// How far the block's frames are off at any vertex.
void MotionSpace::measure_block() {
  const auto known = static_cast<Index>(directions_.size()), count = static_cast<Index>(waiting_);
  const auto length = static_cast<Index>(3 * moving_.size());
  const auto coefficients = coefficients_.block(0, static_cast<Index>(frames_ - waiting_), known, count);
  constexpr Index rows = 3 * 1024;
  const auto pieces = static_cast<size_t>((length + rows - 1) / rows);
  Eigen::MatrixXf most = Eigen::MatrixXf::Zero(count, static_cast<Index>(pieces));
  tbb::parallel_for(size_t{0}, pieces, [&](size_t piece) {
    const Index first = static_cast<Index>(piece) * rows, here = std::min(rows, length - first);
    Eigen::MatrixXf part(rows, known);
    copy_rows(first, here, part);
    Eigen::MatrixXf off = part.topRows(here) * coefficients;
    for (Index f = 0; f < count; ++f) {
      const float* frame = block_[static_cast<size_t>(f)].data();
      for (Index i = 0; i < here; i += 3) {
        const float* place = frame + 3 * moving_[static_cast<size_t>((first + i) / 3)];
        off.col(f).segment<3>(i) -= Eigen::Map<const Eigen::Vector3f>(place);
      }
      most(f, static_cast<Index>(piece)) = largest_length(off.col(f));
    }
  });
  for (Index f = 0; f < count; ++f)
    left_.push_back(pieces > 0 ? most.row(f).maxCoeff() : 0.0F);
}

Eigen::VectorXf MotionSpace::whole(std::span<const float> frame) const {
  Eigen::VectorXf values(static_cast<Index>(3 * moving_.size()));
  for (size_t i = 0; i < moving_.size(); ++i)
    for (size_t axis = 0; axis < 3; ++axis)
      values[static_cast<Index>(3 * i + axis)] = frame[3 * moving_[i] + axis];
  return values;
}

/// What is left of the block's frame `column` becomes a direction.
void MotionSpace::extend(Index column) {
  const auto known = static_cast<Index>(directions_.size());
  const auto first = static_cast<Index>(frames_ - waiting_);
  Eigen::VectorXf at_samples = sampled_left_.col(column);
  Eigen::VectorXf mix = coefficients_.col(first + column).head(known);
  // Once more, so that rounding leaves it orthogonal.
  const Eigen::VectorXf again = sampled_directions_.leftCols(known).transpose() * at_samples;
  at_samples.noalias() -= sampled_directions_.leftCols(known) * again;
  mix += again;
  const float length = at_samples.norm();
  Eigen::VectorXf direction = whole(block_[static_cast<size_t>(column)]);
  for (Index k = 0; k < known; ++k)
    direction.head(directions_[static_cast<size_t>(k)].size()) -=
        mix[k] * directions_[static_cast<size_t>(k)];
  at_samples /= length;
  directions_.push_back(direction / length);
  if (sampled_directions_.cols() <= known) {
    sampled_directions_.conservativeResize(Eigen::NoChange, known + 16);
  }
  sampled_directions_.col(known) = at_samples;
  if (coefficients_.rows() <= known) {
    coefficients_.conservativeResize(known + 16, Eigen::NoChange);
    coefficients_.bottomRows(16).setZero();
  }
  const Eigen::RowVectorXf on_it = at_samples.transpose() * sampled_left_;
  coefficients_.block(known, first, 1, on_it.size()) += on_it;
  sampled_left_.noalias() -= at_samples * on_it;
}

/// Rows `row` .. `row + count` of all directions, zeros where one does not reach.
void MotionSpace::copy_rows(Index row, Index count, Eigen::MatrixXf& to) const {
  to.topRows(count).setZero();
  for (size_t k = 0; k < directions_.size(); ++k) {
    const Index there = std::clamp<Index>(directions_[k].size() - row, 0, count);
    to.col(static_cast<Index>(k)).head(there) =
        directions_[k].segment(std::min(row, directions_[k].size()), there);
  }
}

/// Turns the directions to the take's principal ones so far and keeps the first three quarters. A motion of
/// so many directions is not worth following as closely.
void MotionSpace::give_up_the_least() {
  options_.tolerance *= 1.5;
  is_whole_ = false;
  left_.clear();
  const auto known = static_cast<Index>(directions_.size());
  const Index kept = known - known / 4;
  const auto seen = coefficients_.topLeftCorner(known, static_cast<Index>(frames_));
  const Eigen::MatrixXd gram = (seen * seen.transpose()).cast<double>();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(gram);
  const Eigen::MatrixXf turn = eigen.eigenvectors().rightCols(kept).rowwise().reverse().cast<float>();
  const Eigen::MatrixXf turned = turn.transpose() * seen;
  coefficients_.setZero();
  coefficients_.topLeftCorner(kept, static_cast<Index>(frames_)) = turned;
  sampled_directions_ = (sampled_directions_.leftCols(known) * turn).eval();
  const auto length = static_cast<Index>(3 * moving_.size());
  constexpr Index rows = 4096;
  Eigen::MatrixXf part(rows, known);
  for (Index row = 0; row < length; row += rows) {
    const Index count = std::min(rows, length - row);
    copy_rows(row, count, part);
    const Eigen::MatrixXf mixed = part.topRows(count) * turn;
    for (Index k = 0; k < kept; ++k) {
      Eigen::VectorXf& direction = directions_[static_cast<size_t>(k)];
      if (direction.size() < row + count) direction.conservativeResize(row + count);
      direction.segment(row, count) = mixed.col(k);
    }
  }
  directions_.resize(static_cast<size_t>(kept));
}

Eigen::MatrixXf MotionSpace::mixed(const Eigen::MatrixXf& mix) const {
  const auto length = static_cast<Index>(3 * moving_.size()), known = static_cast<Index>(directions_.size());
  Eigen::MatrixXf result(length, mix.cols());
  constexpr Index rows = 4096;
  Eigen::MatrixXf part(rows, known);
  for (Index row = 0; row < length; row += rows) {
    const Index count = std::min(rows, length - row);
    copy_rows(row, count, part);
    result.middleRows(row, count).noalias() = part.topRows(count) * mix;
  }
  return result;
}

}  // namespace fascia::cli
