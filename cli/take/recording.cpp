#include "cli/take/recording.h"

#include <tbb/parallel_for.h>
#include <tbb/task_group.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

#include "cli/take/keyframes.h"

namespace fascia::cli {

namespace {

using Eigen::Index;
using Eigen::MatrixXf;

// Of what the written motion may be off: the part that directions, components and linear weights may each
// take. Their sum stays below the total, because they rarely have their maxima at the same vertex.
constexpr double share_of_directions = 0.2, share_of_components = 0.75, share_of_keys = 0.2;

/// Every n-th 3-vector of the shapes' rows, some `most` of them.
MatrixXf sampled_rows(const MatrixXf& shapes, Index most) {
  const Index vertices = shapes.rows() / 3, stride = std::max<Index>(1, vertices / most);
  const Index count = (vertices + stride - 1) / stride;
  MatrixXf rows(3 * count, shapes.cols());
  for (Index v = 0; v < count; ++v)
    rows.middleRows<3>(3 * v) = shapes.middleRows<3>(3 * v * stride);
  return rows;
}

/// What is written of the mesh `motion` stands for when shapes may take `aim` of it.
void write_down(const MotionSpace& space, const RecordingOptions& options, double aim, MeshMotion& motion) {
  motion.components = components(space, options.most_targets, share_of_components * aim);
  motion.keys = keys_of_shapes(motion.components.weights, sampled_rows(motion.components.shapes, 600),
                               share_of_keys * aim);
}

/// What shapes and linear weights leave of the directions.
class Remainder {
 public:
  Remainder(const MotionSpace& space, const MeshMotion& motion)
      : space_(space), motion_(motion), weights_(between_keys(motion.components.weights, motion.keys)) {}

  /// #directions.
  Eigen::VectorXf of(size_t frame) const {
    const auto f = static_cast<Index>(frame);
    return space_.coefficients().col(f) - motion_.components.mix * weights_.col(f);
  }

 private:
  const MotionSpace& space_;
  const MeshMotion& motion_;
  MatrixXf weights_;
};

/// The largest error frame by frame is at most what the directions leave of it and what shapes and linear
/// weights leave of those. The latter moves a vertex by no more than its length times the largest gain, so
/// only frames that could be the worst are looked at vertex by vertex.
void bound_errors(const MotionSpace& space, MeshMotion& motion) {
  const Remainder remainder(space, motion);
  const std::vector<float>& left = space.left();
  const float gain = space.largest_gain();
  std::vector<float> most(left.size());
  tbb::parallel_for(size_t{0}, most.size(),
                    [&](size_t f) { most[f] = left[f] + gain * remainder.of(f).norm(); });
  std::vector<size_t> order(most.size());
  std::iota(order.begin(), order.end(), size_t{0});
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return most[a] > most[b]; });
  motion.left = *std::max_element(left.begin(), left.end());
  motion.largest_error = 0.0;
  motion.largest_error_frame = order.front();
  constexpr size_t block = 64;
  for (size_t i = 0; i < order.size(); i += block) {
    if (static_cast<double>(most[order[i]]) <= motion.largest_error) break;
    const std::span<const size_t> frames(order.data() + i, std::min(block, order.size() - i));
    MatrixXf mix(space.coefficients().rows(), static_cast<Index>(frames.size()));
    for (size_t k = 0; k < frames.size(); ++k)
      mix.col(static_cast<Index>(k)) = remainder.of(frames[k]);
    const std::vector<float> off = space.largest_of_mixed(mix);
    for (size_t k = 0; k < frames.size(); ++k) {
      const auto error = static_cast<double>(left[frames[k]] + off[k]);
      if (error <= motion.largest_error) continue;
      motion.largest_error = error;
      motion.largest_error_frame = frames[k];
    }
  }
}

/// Writes down a mesh's motion; where its errors add up to more than they may, once more, aiming lower.
void write_down_within(const MotionSpace& space, const RecordingOptions& options, MeshMotion& motion) {
  double aim = options.tolerance;
  for (int attempt = 0; attempt < 3; ++attempt) {
    write_down(space, options, aim, motion);
    bound_errors(space, motion);
    const bool is_full = motion.components.weights.rows() >= static_cast<Index>(options.most_targets);
    const auto left = static_cast<double>(motion.left);
    if (is_full || motion.largest_error <= options.tolerance || left > 0.5 * options.tolerance) return;
    aim *= 0.95 * (options.tolerance - left) / (motion.largest_error - left);
  }
}

/// Takes the frames of all meshes in while the next ones are simulated, on a thread of its own where there
/// is one. The same, to the last bit, on any number of them.
class Intake {
 public:
  Intake(const std::vector<MeshOfFile>& meshes, std::vector<MotionSpace>& spaces)
      : meshes_(meshes), spaces_(spaces), arriving_(meshes.size() * batch), taken_(meshes.size() * batch) {}
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
          spaces_[m].add(taken_[m * batch + f]);
    });
    count_ = 0;
  }

  const std::vector<MeshOfFile>& meshes_;
  std::vector<MotionSpace>& spaces_;
  std::vector<std::vector<float>> arriving_, taken_;
  size_t count_ = 0;
  tbb::task_group tasks_;
};

}  // namespace

std::vector<MeshOfFile> meshes_of_file(const Face& face) {
  std::map<uint32_t, MeshOfFile> by_mesh;
  for (size_t m = 0; m < face.meshes().size(); ++m) {
    MeshOfFile& mesh = by_mesh[face.meshes()[m].mesh];
    mesh.mesh = face.meshes()[m].mesh;
    mesh.parts.push_back(m);
    mesh.firsts.push_back(mesh.vertices);
    mesh.vertices += face.meshes()[m].vertex_count;
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

Recording record(const Common& common, const Take& take, Face& face, const RecordingOptions& options) {
  Recording recording;
  const std::vector<MeshOfFile> meshes = meshes_of_file(face);
  std::vector<MotionSpace> spaces;
  for (const MeshOfFile& mesh : meshes) {
    MotionSpace::Options space;
    space.tolerance = share_of_directions * options.tolerance;
    space.fine_directions = std::max(space.fine_directions, 5 * options.most_targets / 2);
    space.most_directions = std::max(space.most_directions, 3 * options.most_targets);
    spaces.emplace_back(mesh.vertices, space);
  }
  const auto channels = static_cast<Index>(face.channel_names().size());
  recording.values.resize(channels, static_cast<Index>(take.frames()));
  common.progress("simulation");
  {
    Progress progress(common, "frame", take.frames());
    Intake intake(meshes, spaces);
    recording.figures = perform(take, face, progress, [&](size_t f) {
      intake.add(face);
      recording.values.col(static_cast<Index>(f)) =
          Eigen::Map<const Eigen::VectorXf>(fascia_face_effective_values(face.handle()), channels);
    });
    intake.finish();
  }
  common.progress("principal components");
  for (size_t m = 0; m < meshes.size(); ++m) {
    MotionSpace space = std::move(spaces[m]);  // its memory is free again when it is written down
    space.finish();
    if (space.vertices().empty()) continue;
    MeshMotion motion;
    motion.mesh = meshes[m];
    motion.vertices = space.vertices();
    write_down_within(space, options, motion);
    recording.meshes.push_back(std::move(motion));
  }
  return recording;
}

}  // namespace fascia::cli
