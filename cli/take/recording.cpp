#include "cli/take/recording.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "cli/take/keyframes.h"

namespace fascia::cli {

namespace {

using Eigen::Index;
using Eigen::MatrixXf;

// Of what the written motion may be off: the part that directions, components and linear weights may each
// take. Together they stay below the whole, as they are hardly ever all at their worst in one place.
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

/// The largest error frame by frame is at most what the directions leave of it and what shapes and linear
/// weights leave of those.
void bound_errors(const MotionSpace& space, MeshMotion& motion) {
  motion.largest_error = 0.0;
  if (space.left().size() != space.frames()) return;
  const MatrixXf rest =
      space.coefficients() - motion.components.mix * between_keys(motion.components.weights, motion.keys);
  constexpr Index block = 64;
  std::vector<float> errors = space.left();
  motion.left = *std::max_element(errors.begin(), errors.end());
  tbb::parallel_for(Index{0}, (rest.cols() + block - 1) / block, [&](Index b) {
    const Index first = b * block, count = std::min(block, rest.cols() - first);
    const MatrixXf off = space.mixed(rest.middleCols(first, count));
    for (Index f = 0; f < count; ++f) {
      float most = 0.0F;
      for (Index i = 0; i + 2 < off.rows(); i += 3)
        most = std::max(most, off.col(f).segment<3>(i).squaredNorm());
      errors[static_cast<size_t>(first + f)] += std::sqrt(most);
    }
  });
  const auto worst = std::max_element(errors.begin(), errors.end());
  motion.largest_error = static_cast<double>(*worst);
  motion.largest_error_frame = static_cast<size_t>(worst - errors.begin());
  motion.is_measured = true;
}

/// Writes down a mesh's motion; where its errors add up to more than they may, once more, aiming lower.
void write_down_within(const MotionSpace& space, const RecordingOptions& options, MeshMotion& motion) {
  double aim = options.tolerance;
  for (int attempt = 0; attempt < 3; ++attempt) {
    write_down(space, options, aim, motion);
    bound_errors(space, motion);
    const bool is_full = motion.components.weights.rows() >= static_cast<Index>(options.most_targets);
    const auto left = static_cast<double>(motion.left);
    if (!motion.is_measured || is_full || motion.largest_error <= options.tolerance ||
        left > 0.5 * options.tolerance)
      return;
    aim *= 0.95 * (options.tolerance - left) / (motion.largest_error - left);
  }
}

/// Measures one mesh, some frames at a time.
class Measurement {
 public:
  explicit Measurement(MeshMotion& motion)
      : motion_(motion),
        weights_(between_keys(motion.components.weights, motion.keys)),
        left_(motion.components.shapes.rows(), block_frames) {}

  void add(const std::vector<float>& frame) {
    for (size_t i = 0; i < motion_.vertices.size(); ++i)
      for (size_t axis = 0; axis < 3; ++axis)
        left_(static_cast<Index>(3 * i + axis), waiting_) = frame[3 * motion_.vertices[i] + axis];
    if (++waiting_ == block_frames) finish();
  }

  void finish() {
    auto left = left_.leftCols(waiting_);
    left.noalias() -= motion_.components.shapes * weights_.middleCols(done_, waiting_);
    for (Index f = 0; f < waiting_; ++f)
      for (Index i = 0; i + 2 < left.rows(); i += 3) {
        const auto length = static_cast<double>(left.col(f).segment<3>(i).norm());
        if (length <= motion_.largest_error) continue;
        motion_.largest_error = length;
        motion_.largest_error_frame = static_cast<size_t>(done_ + f);
      }
    done_ += waiting_;
    waiting_ = 0;
  }

 private:
  static constexpr Index block_frames = 16;
  MeshMotion& motion_;
  MatrixXf weights_, left_;
  Index waiting_ = 0, done_ = 0;
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
    space.most_directions = std::max(space.most_directions, 2 * options.most_targets);
    spaces.emplace_back(mesh.vertices, space);
  }
  const auto channels = static_cast<Index>(face.channel_names().size());
  recording.values.resize(channels, static_cast<Index>(take.frames()));
  std::vector<float> frame;
  common.progress("simulation");
  {
    Progress progress(common, "frame", take.frames());
    recording.figures = perform(take, face, progress, [&](size_t f) {
      for (size_t m = 0; m < meshes.size(); ++m) {
        displacement(face, meshes[m], frame);
        spaces[m].add(frame);
      }
      recording.values.col(static_cast<Index>(f)) =
          Eigen::Map<const Eigen::VectorXf>(fascia_face_effective_values(face.handle()), channels);
    });
  }
  common.progress("principal components");
  for (size_t m = 0; m < meshes.size(); ++m) {
    spaces[m].finish();
    if (spaces[m].vertices().empty()) continue;
    MeshMotion motion;
    motion.mesh = meshes[m];
    motion.vertices = spaces[m].vertices();
    write_down_within(spaces[m], options, motion);
    recording.meshes.push_back(std::move(motion));
  }
  return recording;
}

void measure(const Common& common, const Take& take, Face& face, Recording& recording) {
  std::vector<MeshMotion*> unknown;
  for (MeshMotion& motion : recording.meshes)
    if (!motion.is_measured) unknown.push_back(&motion);
  if (unknown.empty()) return;
  std::vector<Measurement> measurements;
  measurements.reserve(unknown.size());
  for (MeshMotion* motion : unknown)
    measurements.emplace_back(*motion);
  std::vector<float> frame;
  common.progress("measurement");
  Progress progress(common, "frame", take.frames());
  perform(take, face, progress, [&](size_t) {
    for (size_t m = 0; m < measurements.size(); ++m) {
      displacement(face, unknown[m]->mesh, frame);
      measurements[m].add(frame);
    }
  });
  for (Measurement& measurement : measurements)
    measurement.finish();
  for (MeshMotion* motion : unknown)
    motion->is_measured = true;
}

}  // namespace fascia::cli
