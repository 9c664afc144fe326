#pragma once

#include <Eigen/SparseCore>
#include <memory>
#include <string>
#include <vector>

#include "geometry/mesh.h"
#include "rig/read/read.h"
#include "sim/jaw_muscles.h"
#include "sim/realtime/solver.h"

/// The inverse problem: activations from observations of a face.
namespace fascia::fit {

/// A rig as a function from activations to vertices, at one level of detail. Lengths in metres, in the rig's
/// axes.
///
/// Vertices are those of all primitives of the file that the rig binds, one after the other, in the order of
/// `primitives`.
class Subject {
 public:
  /// `level` is the name of a level of detail, empty for the finest. Throws fascia::Error when there is none
  /// of that name, or the tissue cannot be simulated.
  Subject(rig::RigFile file, const std::string& level);

  const rig::RigFile& file() const { return file_; }
  const std::vector<rig::Channel>& channels() const { return file_.rig.actuation.channels; }
  const std::string& level_name() const { return file_.rig.tissue.levels[level_].name; }
  size_t vertex_count() const { return rest_.size() / 3; }
  size_t first_vertex(size_t primitive) const { return first_[primitive]; }
  const Eigen::VectorXd& rest() const { return rest_; }  ///< 3 x #vertices
  /// From a primitive's own coordinates to metres.
  Eigen::Matrix4d to_metres(size_t primitive) const;

  size_t level() const { return level_; }  ///< of the rig's tissue
  const sim::FaceModel& model() const { return *model_; }
  const sim::realtime::Model& realtime_model() const { return *fast_model_; }
  /// How vertices follow nodes: #vertices x #nodes.
  const Eigen::SparseMatrix<double, Eigen::RowMajor>& weights() const { return weights_; }
  const std::vector<float>& jaw_shares() const { return jaw_shares_; }  ///< #vertices
  const std::vector<uint8_t>& eyes() const { return eyes_; }  ///< #vertices: 0 none, 1 left, 2 right
  /// True if tissue or jaw moves the vertex; eyes move separately.
  bool follows(size_t vertex) const;
  /// Triangles of all that the rig binds as skin, by vertices of the subject.
  std::vector<Triangle> skin_triangles() const;

  /// Index of a channel, or -1.
  int32_t channel(const std::string& name) const;
  sim::Controls controls(std::span<const float> activations) const;

  /// Computes a static pose, with a warm start if `warm`; `nodes` and `displacements` then refer to it.
  void pose(std::span<const float> activations, bool warm);
  const sim::Positions& nodes() const { return nodes_; }  ///< #nodes, metres
  /// 3 x #vertices, metres.
  Eigen::VectorXd displacements(std::span<const float> activations) const;
  /// d displacement / d jaw (open, forward, lateral) of vertices bound to the jaw itself: 3 x #vertices rows.
  Eigen::MatrixXd jaw_slopes(std::span<const float> activations) const;

 private:
  Mat3 eye_turn(std::span<const float> activations, const std::string& side) const;
  void bind(size_t primitive, const rig::Binding& binding);

  rig::RigFile file_;
  size_t level_ = 0;
  std::unique_ptr<sim::FaceModel> model_;
  sim::JawMuscles jaw_muscles_;
  std::unique_ptr<sim::realtime::Model> fast_model_;
  std::unique_ptr<sim::realtime::Solver> face_;
  std::vector<size_t> first_;
  Eigen::VectorXd rest_;
  Eigen::SparseMatrix<double, Eigen::RowMajor> weights_;
  std::vector<Eigen::Triplet<double>> entries_;
  std::vector<float> jaw_shares_;
  std::vector<uint8_t> eyes_;
  std::vector<sim::Vec3f> positions_;
  sim::Positions nodes_;
};

}  // namespace fascia::fit
