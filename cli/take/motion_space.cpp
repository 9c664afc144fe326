#include "cli/take/motion_space.h"

#include <Eigen/Eigenvalues>
#include <algorithm>

#include "cli/take/largest_length.h"
#include "cli/take/product.h"

namespace fascia::cli {

namespace {

using Eigen::Index;

constexpr size_t block_frames = 32;
constexpr double growth = 1.5;           // of the tolerance, each time there are too many directions
constexpr double share_given_up = 1.0;   // of the tolerance, that all given up of a frame may be long
constexpr size_t fewer_directions = 32;  // where less than so many go, there may be as many more

/// How many of the last rows no frame has more of than `budget` in all.
Index rows_within(const std::vector<Eigen::MatrixXf>& blocks, double budget) {
  const Index rows = blocks.back().rows();
  Eigen::VectorXf most = Eigen::VectorXf::Zero(rows + 1);  // squared, of the last 0, 1, ... rows of a frame
  for (const Eigen::MatrixXf& block : blocks)
    for (Index f = 0; f < block.cols(); ++f) {
      float sum = 0.0F;
      for (Index k = 1; k <= rows; ++k) {
        sum += block(rows - k, f) * block(rows - k, f);
        most[k] = std::max(most[k], sum);
      }
    }
  Index within = 0;
  while (within < rows && static_cast<double>(most[within + 1]) <= budget * budget)
    ++within;
  return within;
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
  if (waiting_ == block_frames) take_block();
}

void MotionSpace::finish() {
  if (waiting_ > 0) take_block();
  block_ = {};
  sampled_frames_ = sampled_left_ = {};
  sampled_directions_.conservativeResize(Eigen::NoChange, static_cast<Index>(directions_.size()));
  coefficients_.setZero(static_cast<Index>(directions_.size()), static_cast<Index>(kept_frames_));
  Index first = 0;
  for (Eigen::MatrixXf& block : taken_) {
    coefficients_.block(0, first, block.rows(), block.cols()) = block;
    first += block.cols();
    block = {};
  }
  taken_ = {};
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
  for (Eigen::VectorXf& direction : directions_)
    direction.conservativeResizeLike(Eigen::VectorXf::Zero(static_cast<Index>(3 * moving_.size())));
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
  const auto known = static_cast<Index>(directions_.size());
  const auto used = sampled_directions_.leftCols(known);
  taken_.emplace_back(used.transpose() * sampled_frames_);
  sampled_left_ = sampled_frames_ - product(sampled_directions_, taken_.back());
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
    if (directions_.size() >= options_.most_directions) {
      options_.tolerance *= growth;
      give_up(share_given_up * options_.tolerance, directions_.size() / 4);
    }
    extend(worst);
    loosen_tolerance();
  }
  kept_frames_ += waiting_;
  waiting_ = 0;
  keep_fewer_frames();
}

/// Keeps one frame of `every_` of the block that was taken in last, and of all where there are too many.
void MotionSpace::keep_fewer_frames() {
  const auto thin = [&](Eigen::MatrixXf& block, Index every) {
    const Index kept = (block.cols() + every - 1) / every;
    kept_frames_ -= static_cast<size_t>(block.cols() - kept);
    if (kept < block.cols()) block = block(Eigen::all, Eigen::seqN(0, kept, every)).eval();
  };
  thin(taken_.back(), static_cast<Index>(every_));
  while (kept_frames_ > options_.most_frames && every_ < block_frames) {
    for (Eigen::MatrixXf& block : taken_)
      thin(block, 2);
    every_ *= 2;
  }
}

/// A motion of many dimensions cannot be stored as accurately as one of few: beyond `fine_directions` the
/// tolerance grows.
void MotionSpace::loosen_tolerance() {
  if (directions_.size() < options_.fine_directions) return;
  options_.tolerance *= growth;
  const size_t before = directions_.size();
  give_up(share_given_up * options_.tolerance, 0);
  if (before - directions_.size() < fewer_directions) options_.fine_directions += fewer_directions;
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
  Eigen::MatrixXf& coefficients = taken_.back();
  Eigen::VectorXf at_samples = sampled_left_.col(column);
  Eigen::VectorXf mix = coefficients.col(column);
  // Once more, so that rounding leaves it orthogonal.
  const Eigen::VectorXf again = sampled_directions_.leftCols(known).transpose() * at_samples;
  at_samples.noalias() -= sampled_directions_.leftCols(known) * again;
  mix += again;
  const float length = at_samples.norm();
  Eigen::VectorXf direction = whole(block_[static_cast<size_t>(column)]);
  for (Index k = 0; k < known; ++k)
    direction -= mix[k] * directions_[static_cast<size_t>(k)];
  at_samples /= length;
  directions_.push_back(direction / length);
  if (sampled_directions_.cols() <= known)
    sampled_directions_.conservativeResize(Eigen::NoChange, known + 16);
  sampled_directions_.col(known) = at_samples;
  coefficients.conservativeResize(known + 1, Eigen::NoChange);
  coefficients.row(known) = at_samples.transpose() * sampled_left_;
  sampled_left_.noalias() -= at_samples * coefficients.row(known);
}

/// The directions from row `row` on.
std::vector<const float*> MotionSpace::columns(Index row) const {
  std::vector<const float*> result;
  for (const Eigen::VectorXf& direction : directions_)
    result.push_back(direction.data() + row);
  return result;
}

/// Turns the directions to the take's principal ones so far and gives up those, `least` at least, of which no
/// kept frame has more than `budget`.
void MotionSpace::give_up(double budget, size_t least) {
  const auto known = static_cast<Index>(directions_.size());
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(known, known);
  for (const Eigen::MatrixXf& block : taken_)
    gram.topLeftCorner(block.rows(), block.rows()) += (block * block.transpose()).cast<double>();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(gram);
  const Eigen::MatrixXf all = eigen.eigenvectors().rowwise().reverse().cast<float>();
  for (Eigen::MatrixXf& block : taken_)
    block = (all.topRows(block.rows()).transpose() * block).eval();
  const Index lost = std::clamp<Index>(rows_within(taken_, budget), static_cast<Index>(least), known - 1),
              kept = known - lost;
  for (Eigen::MatrixXf& block : taken_)
    block = block.topRows(kept).eval();
  const Eigen::MatrixXf turn = all.leftCols(kept);
  sampled_directions_ = (sampled_directions_.leftCols(known) * turn).eval();
  const auto length = static_cast<Index>(3 * moving_.size());
  constexpr Index rows = 4096;
  Eigen::MatrixXf part;
  for (Index row = 0; row < length; row += rows) {
    const Index count = std::min(rows, length - row);
    product(columns(row), count, turn, part);
    for (Index k = 0; k < kept; ++k)
      directions_[static_cast<size_t>(k)].segment(row, count) = part.col(k);
  }
  directions_.resize(static_cast<size_t>(kept));
}

Eigen::MatrixXf MotionSpace::mixed(const Eigen::MatrixXf& mix) const {
  Eigen::MatrixXf result;
  product(columns(0), static_cast<Index>(3 * moving_.size()), mix, result);
  return result;
}

Eigen::MatrixXf MotionSpace::directions_at(std::span<const Index> which) const {
  Eigen::MatrixXf result(3 * static_cast<Index>(which.size()), static_cast<Index>(directions_.size()));
  for (Index k = 0; k < result.cols(); ++k)
    for (size_t i = 0; i < which.size(); ++i)
      result.col(k).segment<3>(static_cast<Index>(3 * i)) =
          directions_[static_cast<size_t>(k)].segment<3>(3 * which[i]);
  return result;
}

}  // namespace fascia::cli
