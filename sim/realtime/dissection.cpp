#include "sim/realtime/dissection.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <bit>

namespace fascia::sim::realtime {
namespace {

using Matrix = Eigen::SparseMatrix<double, Eigen::RowMajor>;

constexpr size_t last_piece = 16;  // unknowns: smaller pieces are not dissected further

const Vec3 directions[] = {{1, 0, 0}, {0, 1, 0},  {0, 0, 1}, {1, 1, 0}, {1, -1, 0},
                           {1, 0, 1}, {1, 0, -1}, {0, 1, 1}, {0, 1, -1}};

/// The nearest float whose lower half is zero, its upper half; `value` must be finite.
uint16_t upper_half(double value) {
  const auto bits = std::bit_cast<uint32_t>(static_cast<float>(value));
  return static_cast<uint16_t>((bits + 0x7fffU + ((bits >> 16U) & 1U)) >> 16U);
}

/// The fewest of two sides' nodes without which no edge joins them: by a greatest matching (König 1931).
std::vector<uint32_t> fewest_between(const std::vector<uint32_t>& near, const std::vector<uint32_t>& far,
                                     const Matrix& matrix) {
  std::vector<std::vector<uint32_t>> joined(near.size());
  for (uint32_t i = 0; i < near.size(); ++i)
    for (Matrix::InnerIterator e(matrix, static_cast<int>(near[i])); e; ++e) {
      const auto found = std::find(far.begin(), far.end(), static_cast<uint32_t>(e.col()));
      if (found != far.end()) joined[i].push_back(static_cast<uint32_t>(found - far.begin()));
    }
  constexpr uint32_t none = ~0U;
  std::vector<uint32_t> partner_of_far(far.size(), none), partner_of_near(near.size(), none);
  std::vector<uint8_t> seen_near(near.size()), seen_far(far.size());
  const auto reach = [&](auto&& self, uint32_t i) -> bool {
    seen_near[i] = 1;
    for (const uint32_t j : joined[i]) {
      if (seen_far[j]) continue;
      seen_far[j] = 1;
      if (partner_of_far[j] == none || self(self, partner_of_far[j])) {
        partner_of_far[j] = i;
        partner_of_near[i] = j;
        return true;
      }
    }
    return false;
  };
  for (uint32_t i = 0; i < near.size(); ++i) {
    std::fill(seen_far.begin(), seen_far.end(), 0);
    reach(reach, i);
  }
  // What alternating paths from near nodes without a partner reach: far ones of it and near ones beside it.
  std::fill(seen_near.begin(), seen_near.end(), 0);
  std::fill(seen_far.begin(), seen_far.end(), 0);
  for (uint32_t i = 0; i < near.size(); ++i)
    if (partner_of_near[i] == none) reach(reach, i);
  std::vector<uint32_t> between;
  for (uint32_t i = 0; i < near.size(); ++i)
    if (!seen_near[i]) between.push_back(near[i]);
  for (uint32_t j = 0; j < far.size(); ++j)
    if (seen_far[j]) between.push_back(far[j]);
  return between;
}

}  // namespace

Dissection::Dissection(const Matrix& matrix, const Positions& places) {
  std::vector<uint32_t> all(static_cast<size_t>(matrix.rows()));
  for (uint32_t i = 0; i < all.size(); ++i)
    all[i] = i;
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
  // Of the planes across several directions through the middle, the one that cuts fewest.
  struct Cut {
    std::vector<uint32_t> near, far, from_near, from_far;
    size_t cost() const { return std::min(from_near.size(), from_far.size()); }
  };
  Cut best;
  std::vector<std::pair<double, uint32_t>> keyed(piece.size());
  const size_t middle = piece.size() / 2;
  for (const Vec3& direction : directions) {
    for (size_t i = 0; i < piece.size(); ++i)
      keyed[i] = {direction.dot(places[piece[i]]), piece[i]};
    std::nth_element(keyed.begin(), keyed.begin() + static_cast<std::ptrdiff_t>(middle), keyed.end());
    for (size_t i = 0; i < keyed.size(); ++i)
      mark_[keyed[i].second] = i < middle ? 1 : 2;
    const auto touches = [&](uint32_t node, uint8_t side) {
      for (Matrix::InnerIterator e(matrix, static_cast<int>(node)); e; ++e)
        if (mark_[static_cast<size_t>(e.col())] == side) return true;
      return false;
    };
    Cut cut;
    for (const uint32_t node : piece) {
      const bool is_near = mark_[node] == 1;
      (is_near ? cut.near : cut.far).push_back(node);
      if (touches(node, is_near ? 2 : 1)) (is_near ? cut.from_near : cut.from_far).push_back(node);
    }
    for (const uint32_t node : piece)
      mark_[node] = 0;
    if (best.near.empty() || cut.cost() < best.cost()) best = std::move(cut);
  }
  const std::vector<uint32_t> between = fewest_between(best.from_near, best.from_far, matrix);
  for (const uint32_t node : between)
    mark_[node] = 1;
  const auto is_between = [this](uint32_t node) { return mark_[node] == 1; };
  std::erase_if(best.near, is_between);
  std::erase_if(best.far, is_between);
  for (const uint32_t node : between)
    mark_[node] = 0;
  if (best.near.empty() || best.far.empty()) {  // everything touches everything
    eliminate(piece);
    return;
  }
  dissect(best.near, matrix, places);
  dissect(best.far, matrix, places);
  eliminate(between);
}

void Dissection::find_rows(const Matrix& matrix) {
  std::vector<uint32_t> position(order_.size()), front_of(order_.size());
  for (uint32_t k = 0; k < order_.size(); ++k)
    position[order_[k]] = k;
  for (uint32_t f = 0; f < fronts_.size(); ++f)
    for (uint32_t c = 0; c < fronts_[f].width; ++c)
      front_of[fronts_[f].first + c] = f;
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

/// Appends a front with its F.
template <class Dense>
void PanelFactor::pack(const Dissection::Front& from, const Dense& matrix, std::vector<uint16_t>& values) {
  constexpr uint32_t wide = batch_width;
  const auto rows = static_cast<uint32_t>(matrix.rows());
  Panels::Front front;
  front.first = from.first;
  front.width = from.width;
  front.blocks = (rows + wide - 1) / wide;
  front.rows = static_cast<uint32_t>(rows_.size());
  front.values = static_cast<uint32_t>(values.size());
  for (uint32_t r = 0; r < front.blocks * wide; ++r) {
    const size_t row = r < from.width ? from.first + r : r < rows ? from.rows[r - from.width] : size_;
    rows_.push_back(static_cast<int32_t>(4 * row));
  }
  for (uint32_t block = 0; block < front.blocks; ++block)
    for (uint32_t c = 0; c < front.columns(block); ++c)
      for (uint32_t r = wide * block; r < wide * (block + 1); ++r)
        values.push_back(r < rows ? upper_half(matrix(r, c)) : uint16_t{0});
  scratch_ = std::max<size_t>(scratch_, std::max(3 * wide * front.blocks, 4 * front.width));
  fronts_.push_back(front);
}

bool PanelFactor::compute(const Dissection& dissection, const Matrix& matrix) {
  // Single precision is twice as fast, and its rounding is hidden by that of the stored fronts; if a pivot is
  // not positive in it, double precision is used.
  if (factor<float>(dissection, matrix) || factor<double>(dissection, matrix)) return true;
  *this = {};  // an incomplete factor is discarded
  return false;
}

template <class Real>
bool PanelFactor::factor(const Dissection& dissection, const Matrix& matrix) {
  using Dense = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
  const auto& fronts = dissection.fronts();
  const auto& order = dissection.order();
  size_ = order.size();
  fronts_.clear();
  rows_.clear();
  scratch_ = 0;
  std::vector<uint16_t> values;
  std::vector<uint32_t> position(size_);
  for (uint32_t k = 0; k < size_; ++k)
    position[order[k]] = k;
  std::vector<Dense> left(fronts.size());  // what each front leaves to its parent
  std::vector<std::vector<uint32_t>> children(fronts.size());
  for (uint32_t f = 0; f < fronts.size(); ++f)
    if (fronts[f].parent >= 0) children[static_cast<size_t>(fronts[f].parent)].push_back(f);
  std::vector<uint32_t> local(size_);
  for (size_t f = 0; f < fronts.size(); ++f) {
    const auto& front = fronts[f];
    const auto width = static_cast<Eigen::Index>(front.width),
               below = static_cast<Eigen::Index>(front.rows.size());
    Dense dense = Dense::Zero(width + below, width + below);
    for (uint32_t c = 0; c < front.width; ++c)
      local[front.first + c] = c;
    for (uint32_t r = 0; r < front.rows.size(); ++r)
      local[front.rows[r]] = front.width + r;
    for (uint32_t c = 0; c < front.width; ++c)
      for (Matrix::InnerIterator e(matrix, static_cast<int>(order[front.first + c])); e; ++e) {
        const uint32_t row = position[static_cast<size_t>(e.col())];
        if (row >= front.first + c) dense(local[row], c) += static_cast<Real>(e.value());
      }
    for (const uint32_t child : children[f]) {
      const auto& rows = fronts[child].rows;
      for (uint32_t c = 0; c < rows.size(); ++c)
        for (uint32_t r = c; r < rows.size(); ++r)
          dense(local[rows[r]], local[rows[c]]) += left[child](r, c);
      left[child].resize(0, 0);
    }
    auto diagonal = dense.topLeftCorner(width, width);
    const Eigen::LLT<Eigen::Ref<Dense>, Eigen::Lower> cholesky(diagonal);  // in place
    if (cholesky.info() != Eigen::Success) return false;
    auto under = dense.bottomLeftCorner(below, width);
    diagonal.template triangularView<Eigen::Lower>().transpose().template solveInPlace<Eigen::OnTheRight>(
        under);
    dense.bottomRightCorner(below, below)
        .template selfadjointView<Eigen::Lower>()
        .rankUpdate(under, Real(-1));
    left[f] = dense.bottomRightCorner(below, below);

    Dense whole(width + below, width);
    whole.topRows(width) =
        diagonal.template triangularView<Eigen::Lower>().solve(Dense::Identity(width, width));
    whole.bottomRows(below).noalias() = -under * whole.topRows(width);
    if (!whole.allFinite()) return false;
    pack(front, whole, values);
  }
  values_ = Aligned<uint16_t>(values.size());
  std::copy(values.begin(), values.end(), values_.data());
  return true;
}

}  // namespace fascia::sim::realtime
