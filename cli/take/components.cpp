#include "cli/take/components.h"

#include <tbb/parallel_for.h>

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <numeric>

#include "cli/take/product.h"

namespace fascia::cli {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::MatrixXf;
using Eigen::VectorXf;

/// Directions of components in the space's coefficients, and how weights are read off coefficients.
struct Fit {
  MatrixXf mix;             ///< #directions x #components
  MatrixXf read;            ///< #components x #directions: weights = read * coefficients
  VectorXf vertex_weights;  ///< #judged: in the squared error it is best for
};

/// Errors at the judged vertices.
struct Errors {
  VectorXf by_vertex, by_frame;  ///< largest
  double largest = 0.0;
};

/// What `fit` leaves at the judged vertices, whose rows of the directions are `rows`.
Errors errors(const MatrixXf& rows, const MatrixXf& coefficients, const Fit& fit) {
  const MatrixXf left = coefficients - fit.mix * (fit.read * coefficients);
  constexpr Index block = 64;
  const Index vertices = rows.rows() / 3, blocks = (left.cols() + block - 1) / block;
  Errors result;
  result.by_frame = VectorXf::Zero(left.cols());
  MatrixXf by_vertex = MatrixXf::Zero(vertices, std::max<Index>(1, blocks));
  tbb::parallel_for(Index{0}, blocks, [&](Index b) {
    const Index first = b * block, count = std::min(block, left.cols() - first);
    const MatrixXf off = product(rows, left.middleCols(first, count));
    for (Index f = 0; f < count; ++f)
      for (Index v = 0; v < vertices; ++v) {
        const float length = off.col(f).segment<3>(3 * v).norm();
        by_vertex(v, b) = std::max(by_vertex(v, b), length);
        result.by_frame[first + f] = std::max(result.by_frame[first + f], length);
      }
  });
  result.by_vertex = by_vertex.rowwise().maxCoeff();
  result.largest = result.by_frame.size() > 0 ? static_cast<double>(result.by_frame.maxCoeff()) : 0.0;
  return result;
}

/// Frames to judge by: those that principal components leave most of, and an even sample of the rest.
std::vector<Index> telling_frames(const MatrixXf& coefficients, const Fit& fit) {
  VectorXf left(coefficients.cols());
  for (Index f = 0; f < left.size(); ++f)
    left[f] = (coefficients.col(f) - fit.mix * (fit.read * coefficients.col(f))).squaredNorm();
  std::vector<Index> order(static_cast<size_t>(left.size()));
  std::iota(order.begin(), order.end(), Index{0});
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return left[a] > left[b]; });
  constexpr size_t most = 600;
  if (order.size() <= 2 * most) return order;
  std::vector<Index> chosen(order.begin(), order.begin() + most);
  for (size_t i = most; i < order.size(); i += (order.size() - most) / most + 1)
    chosen.push_back(order[i]);
  return chosen;
}

MatrixXf columns(const MatrixXf& matrix, const std::vector<Index>& which) {
  MatrixXf result(matrix.rows(), static_cast<Index>(which.size()));
  for (size_t i = 0; i < which.size(); ++i)
    result.col(static_cast<Index>(i)) = matrix.col(which[i]);
  return result;
}

/// The products of the directions at the judged vertices, whose rows are weighted.
MatrixXd metric_of(const MatrixXf& rows, const VectorXf& vertex_weights) {
  MatrixXf scaled = rows;
  for (Index v = 0; v < vertex_weights.size(); ++v)
    scaled.middleRows<3>(3 * v) *= std::sqrt(vertex_weights[v]);
  MatrixXf metric = MatrixXf::Zero(rows.cols(), rows.cols());
  metric.selfadjointView<Eigen::Lower>().rankUpdate(scaled.transpose());
  return MatrixXf(metric.selfadjointView<Eigen::Lower>()).cast<double>();
}

/// Principal components at the weighted judged vertices; `gram` is the sum over all frames of weighted
/// products of coefficients.
Fit weighted_fit(const MatrixXf& rows, const VectorXf& vertex_weights, const MatrixXd& gram, Index count) {
  const Eigen::LLT<MatrixXd> factor(metric_of(rows, vertex_weights));
  const MatrixXd upper = factor.matrixU();
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(upper * gram * upper.transpose());
  const MatrixXd turn = eigen.eigenvectors().rightCols(count).rowwise().reverse();
  Fit fit;
  fit.read = (turn.transpose() * upper).cast<float>();
  fit.mix = upper.triangularView<Eigen::Upper>().solve(turn).cast<float>();
  fit.vertex_weights = vertex_weights;
  return fit;
}

/// Products of each column with itself, weighted, summed.
MatrixXd gram_of(const MatrixXf& columns, const VectorXf& weights) {
  MatrixXf scaled = columns;
  for (Index f = 0; f < scaled.cols(); ++f)
    scaled.col(f) *= weights[f];
  return (scaled * columns.transpose()).cast<double>();
}

/// Weighs up what is off most, round by round, and keeps the best. `gram` is that of all coefficients.
Fit with_least_largest_error(const MatrixXf& rows, const MatrixXf& coefficients, const MatrixXd& gram,
                             const Fit& plain, Index count, double tolerance) {
  constexpr int rounds = 8;
  const std::vector<Index> telling = telling_frames(coefficients, plain);
  const MatrixXf judged = columns(coefficients, telling);
  Fit best = plain;
  Errors now = errors(rows, judged, plain);
  double least = now.largest;
  VectorXf vertex_weights = VectorXf::Ones(now.by_vertex.size());
  VectorXf frame_weights = VectorXf::Ones(judged.cols());
  for (int round = 0; round < rounds && least > tolerance; ++round) {
    // Roots of Lawson's factors: with the whole of both, one after the other overshoots.
    const auto scale = static_cast<float>(now.largest);
    for (Index v = 0; v < vertex_weights.size(); ++v)
      vertex_weights[v] *= std::sqrt(0.1F + now.by_vertex[v] / scale);
    vertex_weights /= vertex_weights.mean();
    vertex_weights = vertex_weights.cwiseMax(1e-4F);
    for (Index f = 0; f < frame_weights.size(); ++f)
      frame_weights[f] *= std::sqrt(0.3F + now.by_frame[f] / scale);
    frame_weights /= frame_weights.mean();
    // Frames that are not judged are no worse than the best of those.
    const float least_weight = frame_weights.minCoeff() * frame_weights.minCoeff();
    const MatrixXd more = gram_of(judged, (frame_weights.array().square() - least_weight).matrix());
    const MatrixXd weighted = static_cast<double>(least_weight) * gram + more;
    const Fit fit = weighted_fit(rows, vertex_weights, weighted, count);
    now = errors(rows, judged, fit);
    if (now.largest < least) {
      least = now.largest;
      best = fit;
    }
  }
  return best;
}

/// The vertices to judge by, by their places among those that move: where `fit` leaves most over the take,
/// and an even sample of the rest.
std::vector<Index> telling_vertices(const MotionSpace& space, const MatrixXd& gram, const Fit& fit) {
  constexpr size_t most = 2000;
  const auto all = space.vertices().size();
  const size_t stride = std::max<size_t>(1, all / (most / 2));
  MatrixXd left = MatrixXd::Identity(gram.rows(), gram.rows());
  left -= (fit.mix * fit.read).cast<double>();
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(left * gram * left.transpose());
  const MatrixXf roots =
      (eigen.eigenvectors() * eigen.eigenvalues().cwiseMax(0.0).cwiseSqrt().asDiagonal()).cast<float>();
  const VectorXf squared = space.mixed(roots).rowwise().squaredNorm();
  std::vector<Index> order(all);
  std::iota(order.begin(), order.end(), Index{0});
  const auto energy = [&](Index v) { return squared.segment<3>(3 * v).sum(); };
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return energy(a) > energy(b); });
  std::vector<Index> chosen(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(std::min(most, all)));
  for (size_t i = most; i < all; i += stride)
    chosen.push_back(order[i]);
  std::sort(chosen.begin(), chosen.end());
  return chosen;
}

}  // namespace

Components components(const MotionSpace& space, size_t limit, double tolerance) {
  Components result;
  const MatrixXf& coefficients = space.coefficients();
  const Index directions = coefficients.rows();
  if (directions == 0 || coefficients.cols() == 0) return result;  // nothing moves farther than it follows
  const MatrixXd gram = (coefficients * coefficients.transpose()).cast<double>();
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(gram);
  const MatrixXf turn = eigen.eigenvectors().rowwise().reverse().cast<float>();
  const auto plain = [&](Index count) {
    return Fit{turn.leftCols(count), turn.leftCols(count).transpose(), {}};
  };
  const Index most = std::min(directions, static_cast<Index>(limit));
  result.judged = telling_vertices(space, gram, plain(most));
  const MatrixXf rows = space.directions_at(result.judged);
  const auto error_of = [&](Index count) {
    const Fit fit = plain(count);
    const std::vector<Index> telling = telling_frames(coefficients, fit);
    return errors(rows, columns(coefficients, telling), fit).largest;
  };
  Index low = 0, high = directions;  // bisection: the error falls with their number, as good as always
  // What is not followed as closely as that would not be reached by any number.
  while (space.tolerance() <= tolerance && high - low > 1) {
    const Index middle = (low + high) / 2;
    (error_of(middle) <= tolerance ? high : low) = middle;
  }
  if (space.tolerance() <= tolerance) result.wanted = static_cast<size_t>(high);
  const Index count = std::min(high, most);
  Fit fit = plain(count);
  if (high > count) fit = with_least_largest_error(rows, coefficients, gram, fit, count, tolerance);
  const std::vector<Index> telling = telling_frames(coefficients, fit);
  result.sampled_error = errors(rows, columns(coefficients, telling), fit).largest;
  const auto judged = static_cast<Index>(result.judged.size());
  result.vertex_weights =
      fit.vertex_weights.size() > 0 ? fit.vertex_weights : VectorXf(VectorXf::Ones(judged));
  const MatrixXf shapes = space.mixed(fit.mix);
  for (Index k = 0; k < count; ++k)
    result.shapes.emplace_back(shapes.col(k));
  return result;
}

}  // namespace fascia::cli
