#include "sim/front_factor.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

namespace fascia::sim {

namespace {

constexpr Eigen::Index at_once = 32;  // columns that the cache holds of all rows

}  // namespace

void FrontFactor::analyse(const Matrix& matrix, const Positions& places) {
  std::vector<Eigen::Triplet<double>> pairs;
  for (int column = 0; column < matrix.outerSize(); column += 3)  // blocks are whole
    for (Matrix::InnerIterator e(matrix, column); e; ++e)
      if (e.row() % 3 == 0) pairs.emplace_back(static_cast<int>(e.row()) / 3, column / 3, 1.0);
  Eigen::SparseMatrix<double, Eigen::RowMajor> nodes(matrix.rows() / 3, matrix.cols() / 3);
  nodes.setFromTriplets(pairs.begin(), pairs.end());
  dissection_ = std::make_unique<const realtime::Dissection>(nodes, places);
  const auto& order = dissection_->order();
  position_.resize(order.size());
  local_.resize(order.size());
  for (uint32_t k = 0; k < order.size(); ++k)
    position_[order[k]] = k;
  const auto& fronts = dissection_->fronts();
  fronts_.assign(fronts.size(), {});
  size_t values = 0;
  work_ = 0.0;
  for (uint32_t f = 0; f < fronts.size(); ++f) {
    Front& front = fronts_[f];
    front.width = 3 * static_cast<Eigen::Index>(fronts[f].width);
    front.below = 3 * static_cast<Eigen::Index>(fronts[f].rows.size());
    front.values = values;
    values += static_cast<size_t>((front.width + front.below) * front.width);
    const auto w = static_cast<double>(front.width), b = static_cast<double>(front.below);
    front.work = w * w * w / 6.0 + w * w * b / 2.0 + w * b * b / 2.0;
    work_ += front.work;
    if (fronts[f].parent >= 0) fronts_[static_cast<size_t>(fronts[f].parent)].children.push_back(f);
  }
  values_.resize(values);
  left_.assign(fronts.size(), {});
}

void FrontFactor::begin(const Matrix& matrix, const Positions& places) {
  matrix_ = matrix;
  places_ = places;
  is_prepared_ = is_sound_ = false;
  next_ = 0;
}

/// Completes the matrix and finds the order where its pattern is a new one.
void FrontFactor::prepare() {
  const Matrix lower = std::move(matrix_);
  matrix_ = lower.selfadjointView<Eigen::Lower>();
  const int columns = static_cast<int>(matrix_.outerSize()), entries = static_cast<int>(matrix_.nonZeros());
  const auto *outer = matrix_.outerIndexPtr(), *inner = matrix_.innerIndexPtr();
  const bool is_known =
      outer_.size() == static_cast<size_t>(columns) + 1 && std::equal(outer_.begin(), outer_.end(), outer) &&
      inner_.size() == static_cast<size_t>(entries) && std::equal(inner_.begin(), inner_.end(), inner);
  if (!is_known) {
    outer_.assign(outer, outer + columns + 1);
    inner_.assign(inner, inner + entries);
    analyse(matrix_, places_);
  }
  is_prepared_ = true;
}

bool FrontFactor::factor_front(size_t index) {
  const auto& nodes = dissection_->fronts()[index];
  const Front& front = fronts_[index];
  const auto& order = dissection_->order();
  const Eigen::Index size = front.width + front.below;
  Dense dense = Dense::Zero(size, size);
  for (uint32_t c = 0; c < nodes.width; ++c)
    local_[nodes.first + c] = 3 * c;
  for (uint32_t r = 0; r < nodes.rows.size(); ++r)
    local_[nodes.rows[r]] = 3 * (nodes.width + r);
  for (uint32_t c = 0; c < nodes.width; ++c) {
    const auto node = static_cast<int>(order[nodes.first + c]);
    for (int k = 0; k < 3; ++k)
      for (Matrix::InnerIterator e(matrix_, 3 * node + k); e; ++e) {
        const auto row = static_cast<uint32_t>(e.row());
        const uint32_t other = position_[row / 3];
        if (other < nodes.first + c) continue;  // it took the block along
        dense(static_cast<Eigen::Index>(local_[other] + row % 3), static_cast<Eigen::Index>(3 * c) + k) +=
            static_cast<float>(e.value());
      }
  }
  for (const uint32_t child : front.children) {
    const auto& rows = dissection_->fronts()[child].rows;
    const Dense& from = left_[child];
    for (size_t c = 0; c < rows.size(); ++c)
      for (size_t r = c; r < rows.size(); ++r)
        dense.block<3, 3>(local_[rows[r]], local_[rows[c]]) +=
            from.block<3, 3>(static_cast<Eigen::Index>(3 * r), static_cast<Eigen::Index>(3 * c));
    left_[child].resize(0, 0);
  }
  auto diagonal = dense.topLeftCorner(front.width, front.width);
  const Eigen::LLT<Eigen::Ref<Dense>, Eigen::Lower> cholesky(diagonal);  // in place
  if (cholesky.info() != Eigen::Success) return false;
  auto under = dense.bottomLeftCorner(front.below, front.width);
  diagonal.triangularView<Eigen::Lower>().transpose().solveInPlace<Eigen::OnTheRight>(under);
  dense.bottomRightCorner(front.below, front.below).selfadjointView<Eigen::Lower>().rankUpdate(under, -1.0F);
  left_[index] = dense.bottomRightCorner(front.below, front.below);
  Eigen::Map<Dense>(values_.data() + front.values, size, front.width) = dense.leftCols(front.width);
  return true;
}

bool FrontFactor::advance(double work) {
  if (!is_prepared_) {
    prepare();
    if (std::isfinite(work)) return fronts_.empty();
  }
  for (double done = 0.0; next_ < fronts_.size() && (done == 0.0 || done < work); ++next_) {
    if (!factor_front(next_)) {
      next_ = fronts_.size();
      return true;
    }
    done += fronts_[next_].work + 1.0;
    if (next_ + 1 == fronts_.size()) is_sound_ = true;
  }
  return next_ >= fronts_.size();
}

bool FrontFactor::compute(const Matrix& matrix, const Positions& places) {
  begin(matrix, places);
  advance(std::numeric_limits<double>::infinity());
  return is_sound_;
}

FrontFactor::Dense FrontFactor::solve(const Dense& right) const {
  return backward(forward(right));
}

FrontFactor::Dense FrontFactor::forward(const Dense& right) const {
  const auto& order = dissection_->order();
  Dense halfway(right.cols(), right.rows());
  for (Eigen::Index first = 0; first < right.cols(); first += at_once) {
    const Eigen::Index count = std::min(at_once, right.cols() - first);
    Dense x(count, right.rows());
    for (size_t k = 0; k < order.size(); ++k)
      x.middleCols<3>(static_cast<Eigen::Index>(3 * k)) =
          right.block(static_cast<Eigen::Index>(3 * order[k]), first, 3, count).transpose();
    go_forward(x);
    halfway.middleRows(first, count) = x;
  }
  return halfway;
}

FrontFactor::Dense FrontFactor::backward(const Dense& halfway) const {
  const auto& order = dissection_->order();
  Dense solution(halfway.cols(), halfway.rows());
  for (Eigen::Index first = 0; first < halfway.rows(); first += at_once) {
    const Eigen::Index count = std::min(at_once, halfway.rows() - first);
    Dense x = halfway.middleRows(first, count);
    go_backward(x);
    for (size_t k = 0; k < order.size(); ++k)
      solution.block(static_cast<Eigen::Index>(3 * order[k]), first, 3, count) =
          x.middleCols<3>(static_cast<Eigen::Index>(3 * k)).transpose();
  }
  return solution;
}

// Rows of the largest front, for memory to be taken once: Eigen 3.4 frees a matrix twice when memory runs out
// while it is made larger.
Eigen::Index FrontFactor::most_below() const {
  Eigen::Index most = 0;
  for (const Front& front : fronts_)
    most = std::max(most, front.below);
  return most;
}

FrontFactor::Panel FrontFactor::panel_of(size_t front) const {
  const Front& f = fronts_[front];
  return {values_.data() + f.values, f.width + f.below, f.width};
}

/// `x` has a row a right-hand side, so that all of a node lie together: nodes are gathered and scattered.
void FrontFactor::go_forward(Dense& x) const {
  Dense below(x.rows(), most_below());
  for (size_t f = 0; f < fronts_.size(); ++f) {
    const Front& front = fronts_[f];
    const auto& nodes = dissection_->fronts()[f];
    auto here = x.middleCols(static_cast<Eigen::Index>(3 * nodes.first), front.width);
    if (here.isZero(0.0F)) continue;  // none of them reaches this far down
    const Panel panel = panel_of(f);
    panel.topRows(front.width)
        .triangularView<Eigen::Lower>()
        .transpose()
        .solveInPlace<Eigen::OnTheRight>(here);
    if (front.below == 0) continue;
    auto bottom = below.leftCols(front.below);
    bottom.noalias() = here * panel.bottomRows(front.below).transpose();
    for (size_t r = 0; r < nodes.rows.size(); ++r)
      x.middleCols<3>(static_cast<Eigen::Index>(3 * nodes.rows[r])) -=
          bottom.middleCols<3>(static_cast<Eigen::Index>(3 * r));
  }
}

void FrontFactor::go_backward(Dense& x) const {
  Dense below(x.rows(), most_below());
  for (size_t f = fronts_.size(); f-- > 0;) {
    const Front& front = fronts_[f];
    const auto& nodes = dissection_->fronts()[f];
    const Panel panel = panel_of(f);
    auto here = x.middleCols(static_cast<Eigen::Index>(3 * nodes.first), front.width);
    if (front.below > 0) {
      auto bottom = below.leftCols(front.below);
      for (size_t r = 0; r < nodes.rows.size(); ++r)
        bottom.middleCols<3>(static_cast<Eigen::Index>(3 * r)) =
            x.middleCols<3>(static_cast<Eigen::Index>(3 * nodes.rows[r]));
      here.noalias() -= bottom * panel.bottomRows(front.below);
    }
    panel.topRows(front.width).triangularView<Eigen::Lower>().solveInPlace<Eigen::OnTheRight>(here);
  }
}

}  // namespace fascia::sim
