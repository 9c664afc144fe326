#include "sim/realtime/dissection.h"

#include <Eigen/Cholesky>
#include <algorithm>

namespace fascia::sim::realtime {
namespace {

using Matrix = Eigen::SparseMatrix<double, Eigen::RowMajor>;

constexpr size_t last_piece = 24;  // unknowns that are not worth cutting further

}  // namespace

Dissection::Dissection(const Matrix& matrix, const Positions& places) {
  std::vector<uint32_t> all(static_cast<size_t>(matrix.rows()));
  for (uint32_t i = 0; i < all.size(); ++i) all[i] = i;
  mark_.assign(all.size(), 0);
  order_.reserve(all.size());
  dissect(all, matrix, places);
  find_rows(matrix);
}

void Dissection::eliminate(const std::vector<uint32_t>& columns) {
  if (columns.empty()) return;
  Front front;
  front.first = static_cast<uint32_t>(order_.size());
  front.width = static_cast<uint32_t>(columns.size());
  order_.insert(order_.end(), columns.begin(), columns.end());
  fronts_.push_back(std::move(front));
}

void Dissection::dissect(std::vector<uint32_t>& piece, const Matrix& matrix, const Positions& places) {
  if (piece.size() <= last_piece) {
    eliminate(piece);
    return;
  }
  // Of the planes across each axis through the middle, the one that cuts fewest.
  std::vector<uint32_t> best_near, best_far, best_between;
  for (int axis = 0; axis < 3; ++axis) {
    std::vector<uint32_t> sorted = piece;
    std::sort(sorted.begin(), sorted.end(), [&](uint32_t a, uint32_t b) {
      return places[a][axis] != places[b][axis] ? places[a][axis] < places[b][axis] : a < b;
    });
    const size_t middle = sorted.size() / 2;
    for (size_t i = 0; i < sorted.size(); ++i) mark_[sorted[i]] = i < middle ? 1 : 2;
    const auto touches = [&](uint32_t node, uint8_t side) {
      for (Matrix::InnerIterator e(matrix, static_cast<int>(node)); e; ++e)
        if (mark_[static_cast<size_t>(e.col())] == side) return true;
      return false;
    };
    std::vector<uint32_t> from_near, from_far;
    for (size_t i = 0; i < sorted.size(); ++i) {
      if (i < middle && touches(sorted[i], 2)) from_near.push_back(sorted[i]);
      if (i >= middle && touches(sorted[i], 1)) from_far.push_back(sorted[i]);
    }
    const std::vector<uint32_t>& between = from_near.size() < from_far.size() ? from_near : from_far;
    if (axis == 0 || between.size() < best_between.size()) {
      best_between = between;
      for (const uint32_t node : between) mark_[node] = 3;
      best_near.clear();
      best_far.clear();
      for (const uint32_t node : sorted) {
        if (mark_[node] == 1) best_near.push_back(node);
        if (mark_[node] == 2) best_far.push_back(node);
      }
    }
    for (const uint32_t node : sorted) mark_[node] = 0;
  }
  if (best_near.empty() || best_far.empty()) {  // everything touches everything
    eliminate(piece);
    return;
  }
  dissect(best_near, matrix, places);
  dissect(best_far, matrix, places);
  eliminate(best_between);
}

void Dissection::find_rows(const Matrix& matrix) {
  std::vector<uint32_t> position(order_.size()), front_of(order_.size());
  for (uint32_t k = 0; k < order_.size(); ++k) position[order_[k]] = k;
  for (uint32_t f = 0; f < fronts_.size(); ++f)
    for (uint32_t c = 0; c < fronts_[f].width; ++c) front_of[fronts_[f].first + c] = f;
  for (uint32_t f = 0; f < fronts_.size(); ++f) {
    Front& front = fronts_[f];  // holds its children's rows already
    const uint32_t end = front.first + front.width;
    for (uint32_t c = front.first; c < end; ++c)
      for (Matrix::InnerIterator e(matrix, static_cast<int>(order_[c])); e; ++e)
        front.rows.push_back(position[static_cast<size_t>(e.col())]);
    std::sort(front.rows.begin(), front.rows.end());
    front.rows.erase(std::unique(front.rows.begin(), front.rows.end()), front.rows.end());
    front.rows.erase(front.rows.begin(), std::lower_bound(front.rows.begin(), front.rows.end(), end));
    if (front.rows.empty()) continue;
    front.parent = static_cast<int32_t>(front_of[front.rows.front()]);
    std::vector<uint32_t>& above = fronts_[static_cast<size_t>(front.parent)].rows;
    above.insert(above.end(), front.rows.begin(), front.rows.end());
  }
}

bool PanelFactor::compute(const Dissection& dissection, const Matrix& matrix) {
  constexpr uint32_t wide = batch_width;
  const auto& fronts = dissection.fronts();
  const auto& order = dissection.order();
  size_ = order.size();
  nodes_.clear();
  rows_.clear();
  std::vector<float> values;
  std::vector<uint32_t> position(size_);
  for (uint32_t k = 0; k < size_; ++k) position[order[k]] = k;
  std::vector<Eigen::MatrixXd> left(fronts.size());       // what each front leaves to its parent
  std::vector<std::vector<uint32_t>> children(fronts.size());
  for (uint32_t f = 0; f < fronts.size(); ++f)
    if (fronts[f].parent >= 0) children[static_cast<size_t>(fronts[f].parent)].push_back(f);
  std::vector<uint32_t> local(size_);
  for (size_t f = 0; f < fronts.size(); ++f) {
    const auto& front = fronts[f];
    const auto width = static_cast<Eigen::Index>(front.width), below = static_cast<Eigen::Index>(front.rows.size());
    Eigen::MatrixXd dense = Eigen::MatrixXd::Zero(width + below, width + below);
    for (uint32_t c = 0; c < front.width; ++c) local[front.first + c] = c;
    for (uint32_t r = 0; r < front.rows.size(); ++r) local[front.rows[r]] = front.width + r;
    for (uint32_t c = 0; c < front.width; ++c)
      for (Matrix::InnerIterator e(matrix, static_cast<int>(order[front.first + c])); e; ++e) {
        const uint32_t row = position[static_cast<size_t>(e.col())];
        if (row >= front.first + c) dense(local[row], c) += e.value();
      }
    for (const uint32_t child : children[f]) {
      const auto& rows = fronts[child].rows;
      for (uint32_t c = 0; c < rows.size(); ++c)
        for (uint32_t r = c; r < rows.size(); ++r) dense(local[rows[r]], local[rows[c]]) += left[child](r, c);
      left[child].resize(0, 0);
    }
    auto diagonal = dense.topLeftCorner(width, width);
    const Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>, Eigen::Lower> cholesky(diagonal);  // in place
    if (cholesky.info() != Eigen::Success) return false;
    auto under = dense.bottomLeftCorner(below, width);
    diagonal.triangularView<Eigen::Lower>().transpose().solveInPlace<Eigen::OnTheRight>(under);
    dense.bottomRightCorner(below, below).selfadjointView<Eigen::Lower>().rankUpdate(under, -1.0);
    left[f] = dense.bottomRightCorner(below, below);

    for (uint32_t c = 0; c < front.width; c += wide) {
      const uint32_t panel = std::min(wide, front.width - c), rows_below = front.width - c - panel + static_cast<uint32_t>(front.rows.size());
      Panels::Node node;
      node.first = front.first + c;
      node.width = panel;
      node.blocks = (rows_below + wide - 1) / wide;
      node.rows = static_cast<uint32_t>(rows_.size());
      node.values = static_cast<uint32_t>(values.size());
      nodes_.push_back(node);
      const Eigen::MatrixXd inverse =
          dense.block(c, c, panel, panel).triangularView<Eigen::Lower>().solve(Eigen::MatrixXd::Identity(panel, panel));
      for (uint32_t column = 0; column < panel; ++column)
        for (uint32_t lane = 0; lane < wide; ++lane)
          values.push_back(lane < panel && lane >= column ? static_cast<float>(inverse(lane, column)) : 0.0F);
      for (uint32_t row = 0; row < node.blocks * wide; ++row) {
        const uint32_t at = c + panel + row;
        rows_.push_back(row >= rows_below         ? static_cast<uint32_t>(size_)
                        : at < front.width ? front.first + at
                                                  : front.rows[at - front.width]);
      }
      for (uint32_t block = 0; block < node.blocks; ++block)
        for (uint32_t column = 0; column < panel; ++column)
          for (uint32_t lane = 0; lane < wide; ++lane) {
            const uint32_t row = block * wide + lane;
            values.push_back(row < rows_below ? static_cast<float>(dense(c + panel + row, c + column)) : 0.0F);
          }
    }
  }
  values_ = Floats(values.size());
  std::copy(values.begin(), values.end(), values_.data());
  return true;
}

}  // namespace fascia::sim::realtime
