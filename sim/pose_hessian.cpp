#include "sim/pose_hessian.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace fascia::sim {
namespace {

using Triplets = std::vector<Eigen::Triplet<double>>;

/// Collects 3 x 3 blocks between nodes into the rows and columns of unknowns, lower half.
struct Blocks {
  const std::vector<int32_t>& unknown;
  Triplets& list;
  void add(uint32_t row, uint32_t column, const Mat3& block) {
    const int32_t r = unknown[row], c = unknown[column];
    if (r < 0 || c < 0 || r < c) return;
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j)
        if (3 * r + i >= 3 * c + j) list.emplace_back(3 * r + i, 3 * c + j, block(i, j));
  }
};

template <size_t Count>
void add_stencils(const std::vector<Curvature::Stencil<Count>>& stencils, Blocks& blocks) {
  for (const auto& s : stencils)
    for (size_t i = 0; i < Count; ++i)
      for (size_t j = 0; j < Count; ++j)
        blocks.add(s.nodes[i], s.nodes[j], s.weights[i] * s.weights[j] * s.block);
}

void add_plates(const std::vector<Curvature::Plate>& plates, Blocks& blocks) {
  for (const auto& p : plates) {
    // The deformation gradient's columns are blends of the three nodes.
    Eigen::Matrix<double, 3, 2> blend;
    blend.row(1) = p.inverse_rest.row(0);
    blend.row(2) = p.inverse_rest.row(1);
    blend.row(0) = -blend.row(1) - blend.row(2);
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) {
        Mat3 block = Mat3::Zero();
        for (int i = 0; i < 2; ++i)
          for (int j = 0; j < 2; ++j)
            block += blend(a, i) * blend(b, j) * p.block.block<3, 3>(3 * i, 3 * j);
        blocks.add(p.nodes[static_cast<size_t>(a)], p.nodes[static_cast<size_t>(b)], block);
      }
  }
}

/// A fibre is included if its pull adds at least this share to the stiffness along itself.
constexpr float least_pull = 0.03F;

}  // namespace

PoseHessian::PoseHessian(const FaceModel& model) : model_(&model), unknown_of_node_(model.rest().size(), -1) {
  for (size_t i = 0; i < model.unknowns().size(); ++i)
    unknown_of_node_[model.unknowns()[i]] = static_cast<int32_t>(i);
  for (const uint32_t node : model.unknowns())
    unknown_places_.push_back(model.rest()[node]);
}

void PoseHessian::begin(const Frame& frame, const Vec3* x) {
  model_->find_curvature(frame, x, curvature_);
  gather_pulls();
  factor_.forget();
  is_regularised_ = is_assembled_ = false;
}

bool PoseHessian::compute(const Frame& frame, const Vec3* x) {
  begin(frame, x);
  advance(std::numeric_limits<double>::infinity());
  return is_sound();
}

bool PoseHessian::advance(double work) {
  if (!is_assembled_) {
    assemble(1e-6);  // regularisation for unconstrained nodes
    is_assembled_ = true;
    if (std::isfinite(work)) return false;
  }
  if (!factor_.is_sound()) {
    if (!factor_.advance(work)) return false;
    if (!factor_.is_sound()) {
      if (is_regularised_) return true;
      is_regularised_ = true;
      assemble(1e-3);
      return advance(work);
    }
    if (std::isfinite(work)) return false;
  }
  return solve_pulls(work);
}

/// Half-solves some columns of the pulls; true when none is left.
bool PoseHessian::solve_pulls(double work) {
  if (pulls_.cols() == 0) return true;
  const double a_column = static_cast<double>(factor_.entries());
  const Eigen::Index left = pulls_.cols() - pulls_done_,
                     count = work < a_column * static_cast<double>(left)
                                 ? std::max<Eigen::Index>(1, static_cast<Eigen::Index>(work / a_column))
                                 : left;
  const Dense halfway = factor_.forward(Eigen::MatrixXd(pulls_.middleCols(pulls_done_, count)).cast<float>());
  for (Eigen::Index row = 0; row < count; ++row)
    if (halfway.row(row).squaredNorm() > least_pull) halfway_pulls_.row(pulls_kept_++) = halfway.row(row);
  pulls_done_ += count;
  if (pulls_done_ < pulls_.cols()) return false;
  Dense small = Dense::Identity(pulls_kept_, pulls_kept_);
  small.selfadjointView<Eigen::Lower>().rankUpdate(halfway_pulls_.topRows(pulls_kept_));
  pull_factor_.compute(small);
  return true;
}

/// The curvature without fibre pulls, plus the share `regularisation` of the rest stiffness's diagonal.
void PoseHessian::assemble(double regularisation) {
  Triplets& list = entries_;
  list.clear();
  Blocks blocks{unknown_of_node_, list};
  add_stencils(curvature_.points, blocks);
  add_stencils(curvature_.pairs, blocks);
  add_stencils(curvature_.quads, blocks);
  add_stencils(curvature_.sixes, blocks);
  add_plates(curvature_.plates, blocks);
  for (const auto& b : curvature_.bends)
    for (size_t i = 0; i < 4; ++i)
      for (size_t j = 0; j < 4; ++j)
        blocks.add(b.nodes[i], b.nodes[j], b.stiffness * b.slopes[i].transpose() * b.slopes[j]);
  for (const auto& v : curvature_.volumes)
    for (size_t i = 0; i < 6; ++i)
      for (size_t j = 0; j < 6; ++j)
        blocks.add(v.nodes[i], v.nodes[j], v.stiffness * v.slopes[i] * v.slopes[j].transpose());
  const auto size = static_cast<Eigen::Index>(3 * model_->unknowns().size());
  const auto& rest = model_->stiffness();
  for (Eigen::Index i = 0; i < size; ++i)
    list.emplace_back(i, i, regularisation * rest.coeff(i / 3, i / 3));
  Eigen::SparseMatrix<double> matrix(size, size);
  matrix.setFromTriplets(list.begin(), list.end());
  factor_.begin(matrix, unknown_places_);
}

void PoseHessian::gather_pulls() {
  const auto size = static_cast<Eigen::Index>(3 * model_->unknowns().size());
  Triplets list;
  for (size_t p = 0; p < curvature_.pulls.size(); ++p) {
    const auto& pull = curvature_.pulls[p];
    for (size_t i = pull.first; i < pull.first + pull.count; ++i) {
      const int32_t unknown = unknown_of_node_[curvature_.pull_nodes[i]];
      const Vec3 slope = std::sqrt(pull.stiffness) * curvature_.pull_slopes[i];
      for (int k = 0; unknown >= 0 && k < 3; ++k)
        list.emplace_back(3 * unknown + k, static_cast<int>(p), slope[k]);
    }
  }
  pulls_.resize(size, static_cast<Eigen::Index>(curvature_.pulls.size()));
  pulls_.setFromTriplets(list.begin(), list.end());
  halfway_pulls_.resize(pulls_.cols(), size);
  pulls_done_ = pulls_kept_ = 0;
}

PoseHessian::Dense PoseHessian::solve(const Dense& right) const {
  Dense halfway = factor_.forward(right);
  if (pulls_kept_ > 0) {
    const auto pulls = halfway_pulls_.topRows(pulls_kept_);
    halfway.noalias() -= pull_factor_.solve(pulls * halfway.transpose()).transpose() * pulls;
  }
  return factor_.backward(halfway);
}

}  // namespace fascia::sim
