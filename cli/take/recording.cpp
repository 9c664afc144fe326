#include "cli/take/recording.h"

#include <tbb/parallel_for.h>
#include <tbb/task_group.h>

#include <Eigen/QR>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>
#include <map>

#include "cli/take/keyframes.h"
#include "cli/take/largest_length.h"
#include "cli/take/product.h"
#include "cli/take/weight_fit.h"

namespace fascia::cli {

namespace {

using Eigen::Index;
using Eigen::MatrixXf;

// Of what the written motion may be off: what shapes may leave at the sample they are chosen by and at any
// vertex, and what the least change of linear weights is that keys are saved for.
constexpr double share_of_directions = 0.2, share_of_components = 0.7, share_of_shapes = 0.85,
                 share_of_keys = 0.15;
// More principal components than that are hardly better than single frames' own shapes.
constexpr size_t most_components = 384;

/// The shapes at every n-th vertex, some `most` of them.
MatrixXf sampled_rows(const std::vector<Eigen::VectorXf>& shapes, Index most) {
  if (shapes.empty()) return {};
  const Index vertices = shapes[0].size() / 3, stride = std::max<Index>(1, vertices / most);
  const Index count = (vertices + stride - 1) / stride;
  MatrixXf rows(3 * count, static_cast<Index>(shapes.size()));
  for (Index k = 0; k < rows.cols(); ++k)
    for (Index v = 0; v < count; ++v)
      rows.col(k).segment<3>(3 * v) = shapes[static_cast<size_t>(k)].segment<3>(3 * v * stride);
  return rows;
}

/// Adds to `off` (#frames) how far at most linear weights between the keys move a vertex.
void add_errors_of_keys(const MeshMotion& motion, std::vector<float>& off) {
  std::vector<const float*> columns;
  for (const Eigen::VectorXf& shape : motion.shapes)
    columns.push_back(shape.data());
  if (columns.empty()) return;
  tbb::parallel_for(size_t{1}, motion.keys.size(), [&](size_t k) {
    const size_t first = motion.keys[k - 1], last = motion.keys[k];
    if (last - first < 2) return;
    MatrixXf moved;
    product(columns, motion.shapes[0].size(), off_line(motion.weights, first, last), moved);
    for (size_t f = first + 1; f < last; ++f)
      off[f] += largest_length(moved.col(static_cast<Index>(f - first - 1)));
  });
}

/// Saves keys as far as the tolerance allows, and keeps the weights at those alone.
void choose_keys(const std::vector<float>& left, double tolerance, MeshMotion& motion) {
  double share = share_of_keys;
  for (int attempt = 0; attempt < 3; ++attempt, share *= 0.5) {
    motion.keys = keys_of_shapes(motion.weights, sampled_rows(motion.shapes, 600), share * tolerance);
    std::vector<float> off = left;
    add_errors_of_keys(motion, off);
    const auto worst = std::max_element(off.begin(), off.end());
    motion.largest_error = static_cast<double>(*worst);
    motion.largest_error_frame = static_cast<size_t>(worst - off.begin());
    if (motion.largest_error <= tolerance) break;
  }
  motion.weights = motion.weights(Eigen::all, motion.keys).eval();
}

/// Shows the frames of each mesh to its taker while the next ones are simulated, on a thread of its own where
/// there is one. The same, to the last bit, on any number of them.
template <class Taker>
class Intake {
 public:
  Intake(const std::vector<MeshOfFile>& meshes, std::vector<Taker>& takers)
      : meshes_(meshes), takers_(takers), arriving_(meshes.size() * batch), taken_(meshes.size() * batch) {}
  Intake(const Intake&) = delete;
  Intake& operator=(const Intake&) = delete;
  ~Intake() { tasks_.wait(); }

  void add(const Face& face) {
    for (size_t m = 0; m < meshes_.size(); ++m)
      displacement(face, meshes_[m], arriving_[m * batch + count_]);
    if (++count_ == batch) hand_over();
  }
  void finish() {
    hand_over();
    tasks_.wait();
  }

 private:
  static constexpr size_t batch = 16;  // frames

  void hand_over() {
    tasks_.wait();
    std::swap(arriving_, taken_);
    tasks_.run([this, count = count_] {
      for (size_t m = 0; m < meshes_.size(); ++m)
        for (size_t f = 0; f < count; ++f)
          takers_[m].add(taken_[m * batch + f]);
    });
    count_ = 0;
  }

  const std::vector<MeshOfFile>& meshes_;
  std::vector<Taker>& takers_;
  std::vector<std::vector<float>> arriving_, taken_;
  size_t count_ = 0;
  tbb::task_group tasks_;
};

/// Simulates the take and shows its frames to the takers, one for each of `meshes`.
template <class Taker>
PerformanceFigures show(const Common& common, const Take& take, const Face& face,
                        const std::vector<MeshOfFile>& meshes, std::vector<Taker>& takers,
                        MatrixXf* values = nullptr) {
  Face fresh = face.sibling();
  const auto channels = static_cast<Index>(fresh.channel_names().size());
  if (values) values->resize(channels, static_cast<Index>(take.frames()));
  Progress progress(common, "frame", take.frames());
  Intake<Taker> intake(meshes, takers);
  const PerformanceFigures figures = perform(take, fresh, progress, [&](size_t f) {
    intake.add(fresh);
    if (values)
      values->col(static_cast<Index>(f)) =
          Eigen::Map<const Eigen::VectorXf>(fascia_face_effective_values(fresh.handle()), channels);
  });
  intake.finish();
  return figures;
}

}  // namespace

namespace {

/// The most that `to` changes for a change of 1 of `from`, where one is an affine function of the other: the
/// largest singular value of its matrix, from all vertices (three numbers each).
double largest_scale(std::span<const float> from, std::span<const float> to) {
  using Places = Eigen::Map<const Eigen::Matrix3Xf>;
  const auto count = static_cast<Index>(from.size() / 3);
  if (count == 0) return 1.0;
  Eigen::Matrix3Xd a = Places(from.data(), 3, count).cast<double>(),
                   b = Places(to.data(), 3, count).cast<double>();
  a.colwise() -= a.rowwise().mean().eval();
  b.colwise() -= b.rowwise().mean().eval();
  const Eigen::Matrix3d matrix =
      (a * a.transpose()).completeOrthogonalDecomposition().solve(a * b.transpose());
  const double scale = matrix.jacobiSvd().singularValues()[0];
  return scale > 0.0 && std::isfinite(scale) ? scale : 1.0;
}

}  // namespace

std::vector<MeshOfFile> meshes_of_file(const Face& face, const Face& in_metres) {
  std::map<uint32_t, MeshOfFile> by_mesh;
  for (size_t m = 0; m < face.meshes().size(); ++m) {
    MeshOfFile& mesh = by_mesh[face.meshes()[m].mesh];
    mesh.mesh = face.meshes()[m].mesh;
    mesh.parts.push_back(m);
    mesh.firsts.push_back(mesh.vertices);
    mesh.vertices += face.meshes()[m].vertex_count;
    const double metres = largest_scale(face.rest(m), in_metres.rest(m));
    mesh.metres = mesh.parts.size() == 1 ? metres : std::max(mesh.metres, metres);
  }
  std::vector<MeshOfFile> meshes;
  for (auto& [number, mesh] : by_mesh)
    meshes.push_back(std::move(mesh));
  return meshes;
}

void displacement(const Face& face, const MeshOfFile& mesh, std::vector<float>& to) {
  to.resize(3 * mesh.vertices);
  for (size_t p = 0; p < mesh.parts.size(); ++p) {
    const std::span<const float> now = face.positions(mesh.parts[p]), rest = face.rest(mesh.parts[p]);
    float* const out = to.data() + 3 * mesh.firsts[p];
    for (size_t i = 0; i < now.size(); ++i)
      out[i] = now[i] - rest[i];
  }
}

Recording record(const Common& common, const Take& take, const Face& face, std::vector<MeshOfFile> meshes,
                 const RecordingOptions& options) {
  Recording recording;
  const size_t most = std::min(options.most_targets, most_components);
  std::vector<MotionSpace> spaces;
  for (const MeshOfFile& mesh : meshes) {
    MotionSpace::Options space;
    space.tolerance = share_of_directions * options.tolerance / mesh.metres;
    space.fine_directions = std::max(space.fine_directions, 3 * most / 2);
    space.most_directions = std::max(space.most_directions, 2 * most);
    spaces.emplace_back(mesh.vertices, space);
  }
  common.progress("simulation");
  recording.figures = show(common, take, face, meshes, spaces, &recording.values);
  common.progress("principal components");
  std::vector<WeightFit> fits;
  std::vector<MeshOfFile> moving;
  for (size_t m = 0; m < meshes.size(); ++m) {
    MotionSpace space = std::move(spaces[m]);  // its memory is free again when the shapes are found
    space.finish();
    if (space.vertices().empty()) continue;
    Components parts = components(space, most, share_of_components * options.tolerance / meshes[m].metres);
    MeshMotion motion{meshes[m], space.vertices(), {}, {}, {}, 0.0, 0, parts.wanted};
    WeightFit::Options fit{share_of_shapes * options.tolerance / meshes[m].metres,
                           options.most_targets - parts.shapes.size()};
    moving.push_back(meshes[m]);
    recording.meshes.push_back(std::move(motion));
    fits.emplace_back(space.vertices(), std::move(parts), fit);
  }
  common.progress("weights");
  if (!fits.empty()) show(common, take, face, moving, fits);
  for (size_t m = 0; m < fits.size(); ++m) {
    MeshMotion& motion = recording.meshes[m];
    WeightFit::Result fitted = fits[m].finish();
    motion.shapes = std::move(fitted.shapes);
    motion.weights = std::move(fitted.weights);
    choose_keys(fitted.left, options.tolerance / motion.mesh.metres, motion);
    motion.largest_error *= motion.mesh.metres;
    if (motion.largest_error <= options.tolerance) motion.wanted = motion.shapes.size();
  }
  return recording;
}

}  // namespace fascia::cli
