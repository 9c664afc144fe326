#pragma once

#include <span>
#include <vector>

#include "fascia/fascia.h"
#include "rig/read/read.h"
#include "sim/jaw.h"

namespace fascia::runtime {

using rig::Vec3f;

/// Where the bones stand and the tissue has gone: what bound vertices follow.
struct BonePose {
  std::span<const Vec3f> displacements;  ///< #nodes, metres
  sim::RigidTransform jaw;
  std::array<Eigen::Matrix3f, 2> eyes = {Eigen::Matrix3f::Identity(), Eigen::Matrix3f::Identity()};  ///< left, right
  std::array<Vec3f, 2> eye_centres = {Vec3f::Zero(), Vec3f::Zero()};
};

/// One primitive of the file as a face sees it: its vertices follow the lattice, the jaw and the eyes.
///
/// Positions and normals are in the space it was made for. At rest they are the file's own, to the last bit.
class BoundMesh {
 public:
  /// `binding` may be null: the mesh then stands still. Both arguments must outlive this.
  BoundMesh(const rig::Primitive& primitive, const rig::Binding* binding, const rig::Mat4f& input_to_metres,
            fascia_space space);

  /// Moves the vertices. Allocates nothing.
  void follow(const BonePose& pose);

  const std::vector<Vec3f>& positions() const { return positions_; }

  /// Normals of the present positions, computed when they have changed. Allocates on first use.
  const std::vector<Vec3f>& normals();

 private:
  Vec3f displacement(const BonePose& pose, std::size_t vertex) const;
  void prepare_normals();
  void surface_normals(const std::vector<Vec3f>& positions, std::vector<Vec3f>& normals) const;

  const rig::Primitive& primitive_;
  const rig::Binding* binding_;
  Eigen::Matrix3f from_metres_;      ///< linear part: displacement in metres to one in the space
  std::vector<Vec3f> rest_metres_;   ///< #vertices
  std::vector<Vec3f> rest_;          ///< #vertices, in the space
  std::vector<Vec3f> positions_;
  Eigen::Matrix3f normal_matrix_;    ///< the primitive's normals to the space
  std::vector<uint32_t> welded_;     ///< #vertices: the first vertex at the same place
  std::vector<Vec3f> rest_normals_, rest_surface_normals_, surface_normals_, normals_;
  bool normals_stale_ = true;
};

}  // namespace fascia::runtime
