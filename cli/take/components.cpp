#include "cli/take/components.h"

#include <Eigen/Cholesky>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <numeric>

namespace fascia::cli {

namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::MatrixXf;
using Eigen::VectorXf;

/// Directions of components in the space's coefficients, and how weights are read off coefficients.
struct Fit {
  MatrixXf mix;   ///< #directions x #components
  MatrixXf read;  ///< #components x #directions: weights = read * coefficients
};

/// Errors at the sampled vertices: rows vertices, columns frames.
struct Errors {
  VectorXf by_vertex, by_frame;  ///< largest
  double largest = 0.0;
};

Errors errors(const MotionSpace& space, const MatrixXf& coefficients, const Fit& fit) {
  const MatrixXf left = coefficients - fit.mix * (fit.read * coefficients);
  Errors result;
  result.by_vertex = VectorXf::Zero(space.sampled_directions().rows() / 3);
  result.by_frame = VectorXf::Zero(left.cols());
  constexpr Index block = 64;
  for (Index first = 0; first < left.cols(); first += block) {
    const Index count = std::min(block, left.cols() - first);
    const MatrixXf off = space.sampled_directions().leftCols(left.rows()) * left.middleCols(first, count);
    for (Index f = 0; f < count; ++f)
      for (Index v = 0; v < result.by_vertex.size(); ++v) {
        const float length = off.col(f).segment<3>(3 * v).norm();
        result.by_vertex[v] = std::max(result.by_vertex[v], length);
        result.by_frame[first + f] = std::max(result.by_frame[first + f], length);
      }
  }
  result.largest = result.by_frame.size() > 0 ? static_cast<double>(result.by_frame.maxCoeff()) : 0.0;
  return result;
}

/// Frames to judge by: those that principal components leave most of, and an even sample of the rest.
std::vector<Index> telling_frames(const MatrixXf& coefficients, const Fit& fit) {
  const VectorXf left = (coefficients - fit.mix * (fit.read * coefficients)).colwise().squaredNorm();
  std::vector<Index> order(static_cast<size_t>(left.size()));
  std::iota(order.begin(), order.end(), Index{0});
  std::stable_sort(order.begin(), order.end(), [&](Index a, Index b) { return left[a] > left[b]; });
  constexpr size_t most = 300;
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

/// Principal components under weights of vertices and frames, both squared: the metric of the sampled
/// vertices in the coefficients is `metric`.
Fit weighted_fit(const MatrixXf& coefficients, const MatrixXd& metric, const VectorXf& frame_weights,
                 Index count) {
  const Eigen::LLT<MatrixXd> factor(metric);
  const MatrixXd upper = factor.matrixU();
  const MatrixXf scaled = coefficients * frame_weights.asDiagonal();
  const MatrixXd gram = upper * (scaled * scaled.transpose()).cast<double>() * upper.transpose();
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(gram);
  const MatrixXd turn = eigen.eigenvectors().rightCols(count).rowwise().reverse();
  Fit fit;
  fit.read = (turn.transpose() * upper).cast<float>();
  fit.mix = upper.triangularView<Eigen::Upper>().solve(turn).cast<float>();
  return fit;
}

MatrixXd metric_of(const MotionSpace& space, Index directions, const VectorXf& vertex_weights) {
  MatrixXf scaled = space.sampled_directions().leftCols(directions);
  for (Index v = 0; v < vertex_weights.size(); ++v)
    scaled.middleRows<3>(3 * v) *= std::sqrt(vertex_weights[v]);
  return (scaled.transpose() * scaled).cast<double>();
}

/// Weighs up what is off most, round by round, and keeps the best.
Fit with_least_largest_error(const MotionSpace& space, const MatrixXf& coefficients, const Fit& plain,
                             Index count, double tolerance) {
  constexpr int rounds = 12;
  const std::vector<Index> telling = telling_frames(coefficients, plain);
  const MatrixXf judged = columns(coefficients, telling);
  Fit best = plain;
  Errors now = errors(space, judged, plain);
  double least = now.largest;
  VectorXf vertex_weights = VectorXf::Ones(now.by_vertex.size());
  VectorXf frame_weights = VectorXf::Ones(coefficients.cols());
  for (int round = 0; round < rounds && least > tolerance; ++round) {
    const auto scale = static_cast<float>(now.largest);
    for (Index v = 0; v < vertex_weights.size(); ++v)
      vertex_weights[v] *= 0.1F + now.by_vertex[v] / scale;
    vertex_weights /= vertex_weights.mean();
    vertex_weights = vertex_weights.cwiseMax(1e-4F);
    for (size_t i = 0; i < telling.size(); ++i)
      frame_weights[telling[i]] *= 0.3F + now.by_frame[static_cast<Index>(i)] / scale;
    const Fit fit = weighted_fit(coefficients, metric_of(space, coefficients.rows(), vertex_weights),
                                 frame_weights, count);
    now = errors(space, judged, fit);
    if (now.largest < least) {
      least = now.largest;
      best = fit;
    }
  }
  return best;
}

}  // namespace

Components components(const MotionSpace& space, size_t limit, double tolerance) {
  Components result;
  const MatrixXf& coefficients = space.coefficients();
  const Index directions = coefficients.rows();
  if (directions == 0 || coefficients.cols() == 0) {  // nothing moves farther than the space follows
    result.shapes.resize(static_cast<Index>(3 * space.vertices().size()), 0);
    result.mix.resize(directions, 0);
    result.weights.resize(0, static_cast<Index>(space.frames()));
    return result;
  }
  const MatrixXd gram = (coefficients * coefficients.transpose()).cast<double>();
  const Eigen::SelfAdjointEigenSolver<MatrixXd> eigen(gram);
  const MatrixXf turn = eigen.eigenvectors().rowwise().reverse().cast<float>();
  const auto plain = [&](Index count) { return Fit{turn.leftCols(count), turn.leftCols(count).transpose()}; };
  const auto error_of = [&](Index count) {
    const Fit fit = plain(count);
    const std::vector<Index> telling = telling_frames(coefficients, fit);
    return errors(space, columns(coefficients, telling), fit).largest;
  };
  Index low = 0, high = directions;  // bisection: the error falls with their number, as good as always
  while (high - low > 1) {
    const Index middle = (low + high) / 2;
    (error_of(middle) <= tolerance ? high : low) = middle;
  }
  if (space.tolerance() <= tolerance) result.wanted = static_cast<size_t>(high);
  const Index count = std::min(high, static_cast<Index>(limit));
  Fit fit = plain(count);
  if (high > count) fit = with_least_largest_error(space, coefficients, fit, count, tolerance);
  result.sampled_error = errors(space, columns(coefficients, telling_frames(coefficients, fit)), fit).largest;
  result.weights = fit.read * coefficients;
  // Weights of at most 1, so that a slider in a viewer means something.
  for (Index k = 0; k < count; ++k) {
    const float peak = result.weights.row(k).cwiseAbs().maxCoeff();
    if (!(peak > 0.0F)) continue;
    result.weights.row(k) /= peak;
    fit.mix.col(k) *= peak;
  }
  result.shapes = space.mixed(fit.mix);
  result.mix = std::move(fit.mix);
  return result;
}

}  // namespace fascia::cli
