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

  /// Moves the vertices, once somebody has asked for them; `held` (0..1) of what `change_shape` kept is
  /// added. Allocates nothing.
  void follow(const BonePose& pose, float held = 0.0F);

  /// Follows another shape of the same primitive from now on (another level of detail). With `fades` the
  /// vertices stay shown where they are, and `follow` lets them go from there.
  void change_shape(const MeshShape& shape, const BonePose& pose, bool fades);
  /// Forgets where an earlier shape had the vertices; the next `follow` shows them where they belong.
  void let_go();

  const MeshShape& shape() const { return *shape_; }

  /// Positions at `pose`, the one last followed; from now on they keep up. Allocates on first use.
  const std::vector<Vec3f>& positions(const BonePose& pose);
  /// Normals of them, computed when they have changed.
  const std::vector<Vec3f>& normals(const BonePose& pose);
  /// Tangents with their handedness, computed when the positions have changed; empty when the file has none
  /// and no texture coordinates either.
  const std::vector<Vec4f>& tangents(const BonePose& pose);

 private:
  const MeshShape* shape_;
  std::vector<Vec3f> positions_, surface_normals_, normals_, held_;
  std::vector<Vec4f> tangents_;
  bool is_wanted_ = false, normals_stale_ = true, tangents_stale_ = true;
};

}  // namespace fascia::runtime
