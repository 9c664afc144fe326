#include "cli/motion.h"

#include <Eigen/Dense>

namespace fascia::cli {

std::vector<PrimitiveMotion> motion_from_rest(const Face& face) {
  std::vector<PrimitiveMotion> motions;
  for (size_t m = 0; m < face.meshes().size(); ++m) {
    const std::span<const float> now = face.positions(m), rest = face.rest(m);
    PrimitiveMotion motion{face.meshes()[m].mesh, face.meshes()[m].primitive, {}};
    bool moves = false;
    for (size_t i = 0; i + 2 < now.size(); i += 3) {
      motion.displacement.emplace_back(now[i] - rest[i], now[i + 1] - rest[i + 1], now[i + 2] - rest[i + 2]);
      moves |= !motion.displacement.back().isZero(0);
    }
    if (moves) motions.push_back(std::move(motion));
  }
  return motions;
}

BakedShapes bake_shapes(const Common& common, Face& face,
                        const std::vector<std::pair<std::string, std::string>>& targets) {
  BakedShapes baked;
  for (const auto& [name, what_to_set] : targets) {
    common.progress("baking " + name);
    // Each shape from rest: the order in which they are baked leaves no trace.
    face.clear();
    face.reset();
    face.set(what_to_set, 1.0);
    face.pose();
    baked.names.push_back(name);
    baked.shapes.push_back(motion_from_rest(face));
  }
  return baked;
}

Components principal_components(const std::vector<std::vector<float>>& frames, size_t limit,
                                double tolerance) {
  Components result;
  if (frames.empty() || frames[0].empty()) return result;
  const Eigen::Index count = static_cast<Eigen::Index>(frames.size()),
                     size = static_cast<Eigen::Index>(frames[0].size());
  Eigen::MatrixXf motion(size, count);
  for (Eigen::Index f = 0; f < count; ++f)
    motion.col(f) = Eigen::Map<const Eigen::VectorXf>(frames[static_cast<size_t>(f)].data(), size);
  // Frames are far fewer than coordinates: the eigenvectors of the small Gram matrix give the components.
  const Eigen::MatrixXd gram = (motion.transpose() * motion).cast<double>();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(gram);
  Eigen::MatrixXf left = motion;
  for (size_t k = 0; k < limit && static_cast<Eigen::Index>(k) < count; ++k) {
    const double largest = left.cwiseAbs().maxCoeff();
    result.largest_error = std::sqrt(3.0) * largest;
    if (result.largest_error <= tolerance) break;
    const Eigen::Index column = count - 1 - static_cast<Eigen::Index>(k);
    if (eigen.eigenvalues()[column] <= 1e-14 * eigen.eigenvalues()[count - 1]) break;
    const Eigen::VectorXf turn = eigen.eigenvectors().col(column).cast<float>();
    const Eigen::VectorXf direction = motion * turn;
    // Weights of at most 1, so that a slider in a viewer means something.
    const float peak = turn.cwiseAbs().maxCoeff();
    const Eigen::VectorXf shape = direction * peak;
    const Eigen::VectorXf weights = turn / peak;
    left.noalias() -= shape * weights.transpose();
    result.shapes.emplace_back(shape.data(), shape.data() + size);
    result.weights.emplace_back(weights.data(), weights.data() + count);
  }
  result.largest_error = 0.0;
  for (Eigen::Index f = 0; f < count; ++f)
    for (Eigen::Index i = 0; i + 2 < size; i += 3)
      result.largest_error =
          std::max(result.largest_error, static_cast<double>(left.col(f).segment<3>(i).norm()));
  return result;
}

}  // namespace fascia::cli
