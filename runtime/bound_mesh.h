#pragma once

#include <span>
#include <vector>

#include "runtime/mesh_shape.h"
#include "sim/jaw.h"

namespace fascia::runtime {

/// Where the bones stand and the tissue has gone: what bound vertices follow.
struct BonePose {
  std::span<const Vec3f> displacements;  ///< #nodes, metres
  sim::RigidTransform jaw;
  std::array<Eigen::Matrix3f, 2> eyes = {Eigen::Matrix3f::Identity(),
                                         Eigen::Matrix3f::Identity()};  ///< left, right
  std::array<Vec3f, 2> eye_centres = {Vec3f::Zero(), Vec3f::Zero()};
};

/// One primitive of the file as a face sees it: its vertices follow the lattice, the jaw and the eyes. At
/// rest they are the file's own, to the last bit. A mesh nobody has asked for costs neither memory nor time.
class BoundMesh {
 public:
  /// `shape` must outlive this.
  explicit BoundMesh(const MeshShape& shape) : shape_(&shape) {}

  std::size_t vertex_count() const { return shape_->rest().size(); }

  /// Moves the vertices, once somebody has asked for them. Allocates nothing.
  void follow(const BonePose& pose);

  /// Positions at `pose`, the one last followed; from now on they keep up. Allocates on first use.
  const std::vector<Vec3f>& positions(const BonePose& pose);
  /// Normals of them, computed when they have changed.
  const std::vector<Vec3f>& normals(const BonePose& pose);

 private:
  const MeshShape* shape_;
  std::vector<Vec3f> positions_, surface_normals_, normals_;
  bool is_wanted_ = false, normals_stale_ = true;
};

}  // namespace fascia::runtime
