#include "cli/take/keyframes.h"

#include <algorithm>

namespace fascia::cli {

namespace {

using Eigen::Index;
using Eigen::MatrixXf;

constexpr size_t longest_span = 256;  // frames

/// From each key as far as `fits(first, last)` goes: doubling, then bisection.
template <class Fits>
std::vector<size_t> keys(size_t frames, Fits fits) {
  std::vector<size_t> kept;
  if (frames == 0) return kept;
  kept.push_back(0);
  while (kept.back() + 1 < frames) {
    const size_t first = kept.back(), most = std::min(frames - 1, first + longest_span);
    size_t good = first + 1, bad = most + 1;
    for (size_t span = 2; good < most; span *= 2) {
      const size_t last = std::min(first + span, most);
      if (!fits(first, last)) {
        bad = last;
        break;
      }
      good = last;
    }
    while (bad - good > 1) {
      const size_t middle = (good + bad) / 2;
      (fits(first, middle) ? good : bad) = middle;
    }
    kept.push_back(good);
  }
  return kept;
}

}  // namespace

MatrixXf off_line(const MatrixXf& values, size_t first, size_t last) {
  const auto from = static_cast<Index>(first), count = static_cast<Index>(last - first) - 1;
  MatrixXf off = values.middleCols(from + 1, count);
  const Eigen::VectorXf start = values.col(from), whole = values.col(static_cast<Index>(last)) - start;
  for (Index f = 0; f < count; ++f)
    off.col(f) -= start + whole * (static_cast<float>(f + 1) / static_cast<float>(last - first));
  return off;
}

std::vector<size_t> keys_of(const MatrixXf& values, std::span<const float> tolerances) {
  const Eigen::Map<const Eigen::VectorXf> most(tolerances.data(), static_cast<Index>(tolerances.size()));
  return keys(static_cast<size_t>(values.cols()), [&](size_t first, size_t last) {
    if (last - first < 2) return true;
    return ((off_line(values, first, last).cwiseAbs().colwise() - most).array() <= 0.0F).all();
  });
}

std::vector<size_t> keys_of_shapes(const MatrixXf& weights, const MatrixXf& shapes, double tolerance) {
  const auto most = static_cast<float>(tolerance * tolerance);
  return keys(static_cast<size_t>(weights.cols()), [&](size_t first, size_t last) {
    if (last - first < 2) return true;
    const MatrixXf off = shapes * off_line(weights, first, last);
    for (Index f = 0; f < off.cols(); ++f)
      for (Index i = 0; i + 2 < off.rows(); i += 3)
        if (off.col(f).segment<3>(i).squaredNorm() > most) return false;
    return true;
  });
}

}  // namespace fascia::cli
