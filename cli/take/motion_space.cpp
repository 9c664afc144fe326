#include "cli/take/motion_space.h"

#include "cli/take/product.h"

#include <tbb/parallel_for.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <numeric>

namespace fascia::cli {

namespace {

using Eigen::Index;

constexpr size_t block_frames = 32;
constexpr double growth = 1.5;           // of the tolerance, each time there are too many directions
constexpr double share_given_up = 1.0;   // of the tolerance, that all given up of a frame may be long
constexpr size_t fewer_directions = 32;  // where less than so many go, there may be as many more

/// The largest length of the 3-vectors in a column.
float largest_length(const Eigen::Ref<const Eigen::VectorXf>& column) {
  float most = 0.0F;
  for (Index i = 0; i + 2 < column.size(); i += 3)
    most = std::max(most, column.segment<3>(i).squaredNorm());
  return std::sqrt(most);
}

/// The largest length of a vertex's rows, of which the squares are given.
float largest_row(const Eigen::VectorXf& squared) {
  float most = 0.0F;
  for (Index i = 0; i + 2 < squared.size(); i += 3)
    most = std::max(most, squared.segment<3>(i).sum());
  return std::sqrt(most);
}

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
  ++frames_;
  if (waiting_ == block_frames) take_block();
}

void MotionSpace::finish() {
  if (waiting_ > 0) take_block();
  block_ = {};
  sampled_frames_ = sampled_left_ = {};
  sampled_directions_.conservativeResize(Eigen::NoChange, static_cast<Index>(directions_.size()));
  coefficients_.setZero(static_cast<Index>(directions_.size()), static_cast<Index>(frames_));
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
  measure_block();
  waiting_ = 0;
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

/// How far the block's frames are off at any vertex.
void MotionSpace::measure_block() {
  const auto count = static_cast<Index>(waiting_);
  const auto length = static_cast<Index>(3 * moving_.size());
  const Eigen::MatrixXf& coefficients = taken_.back();
  constexpr Index rows = 3 * 1024;
  const auto pieces = static_cast<size_t>((length + rows - 1) / rows);
  Eigen::MatrixXf most = Eigen::MatrixXf::Zero(count, static_cast<Index>(pieces));
  tbb::parallel_for(size_t{0}, pieces, [&](size_t piece) {
    const Index first = static_cast<Index>(piece) * rows, here = std::min(rows, length - first);
    Eigen::MatrixXf off;
    product(columns(first), here, coefficients, off);
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
/// frame has more than `budget`. What it had is added to what is left of it.
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
  add_what_is_lost(mixed(all.rightCols(lost)), 0.05 * budget);
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

/// `directions` (3 #moving vertices x #lost) are given up: the last rows of each block's coefficients. What
/// is surely less than `little` is added as what it is at most, the rest as it is. The block that is being
/// taken in is measured when that is done.
void MotionSpace::add_what_is_lost(const Eigen::MatrixXf& directions, double little) {
  if (directions.cols() == 0) return;
  const float gain = largest_row(directions.rowwise().squaredNorm());
  tbb::parallel_for(size_t{0}, taken_.size() - 1, [&](size_t b) {
    const auto mix = taken_[b].bottomRows(directions.cols());
    std::vector<Index> looked_at;
    for (Index f = 0; f < mix.cols(); ++f) {
      const float most = gain * mix.col(f).norm();
      if (static_cast<double>(most) > little)
        looked_at.push_back(f);
      else
        left_[b * block_frames + static_cast<size_t>(f)] += most;
    }
    if (looked_at.empty()) return;
    const Eigen::MatrixXf off = product(directions, mix(Eigen::all, looked_at));
    for (size_t i = 0; i < looked_at.size(); ++i)
      left_[b * block_frames + static_cast<size_t>(looked_at[i])] +=
          largest_length(off.col(static_cast<Index>(i)));
  });
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

std::vector<float> MotionSpace::largest_of_mixed(const Eigen::MatrixXf& mix) const {
  const auto length = static_cast<Index>(3 * moving_.size());
  constexpr Index rows = 3 * 1024;
  const Index pieces = (length + rows - 1) / rows;
  Eigen::MatrixXf most = Eigen::MatrixXf::Zero(mix.cols(), std::max<Index>(1, pieces));
  tbb::parallel_for(Index{0}, pieces, [&](Index piece) {
    const Index first = piece * rows, here = std::min(rows, length - first);
    Eigen::MatrixXf moved;
    product(columns(first), here, mix, moved);
    for (Index c = 0; c < mix.cols(); ++c)
      most(c, piece) = largest_length(moved.col(c));
  });
  std::vector<float> largest(static_cast<size_t>(mix.cols()));
  for (Index c = 0; c < mix.cols(); ++c)
    largest[static_cast<size_t>(c)] = most.row(c).maxCoeff();
  return largest;
}

float MotionSpace::largest_gain() const {
  Eigen::VectorXf squared = Eigen::VectorXf::Zero(static_cast<Index>(3 * moving_.size()));
  for (const Eigen::VectorXf& direction : directions_)
    squared += direction.cwiseAbs2();
  return largest_row(squared);
}

}  // namespace fascia::cli
