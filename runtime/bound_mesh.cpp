#include "runtime/bound_mesh.h"

#include <Eigen/Geometry>

namespace fascia::runtime {

void BoundMesh::follow(const BonePose& pose) {
  if (!is_wanted_) return;
  const Eigen::Matrix3f& from_metres = shape_->from_metres();
  const Eigen::Matrix3f turn = pose.jaw.rotation.cast<float>();
  const Vec3f shift = pose.jaw.translation.cast<float>();
  const std::vector<uint32_t>& nodes = shape_->nodes();
  const std::vector<float>& weights = shape_->weights();
  for (const MeshShape::Follower& follower : shape_->followers()) {
    const Vec3f& rest = shape_->rest_metres(follower.vertex);
    Vec3f moved = Vec3f::Zero();
    if (follower.eye != 0) {
      const Vec3f arm = rest - pose.eye_centres[follower.eye - 1];
      moved = pose.eyes[follower.eye - 1] * arm - arm;
    } else {
      for (uint32_t i = follower.first; i < follower.end; ++i)
        moved += weights[i] * pose.displacements[nodes[i]];
      if (follower.jaw_share != 0.0F) moved += follower.jaw_share * (turn * rest + shift - rest);
    }
    positions_[follower.vertex] = shape_->rest()[follower.vertex] + from_metres * moved;
  }
  normals_stale_ = true;
}

const std::vector<Vec3f>& BoundMesh::positions(const BonePose& pose) {
  if (!is_wanted_) {
    positions_ = shape_->rest();
    is_wanted_ = true;
    follow(pose);
  }
  return positions_;
}

const std::vector<Vec3f>& BoundMesh::normals(const BonePose& pose) {
  positions(pose);
  if (!normals_stale_) return normals_;
  normals_stale_ = false;
  const MeshShape::Normals& rest = shape_->normals();
  shape_->surface_normals(positions_, rest.welded, surface_normals_);
  normals_.resize(positions_.size());
  for (std::size_t v = 0; v < normals_.size(); ++v) {
    if (surface_normals_[v] == rest.surface[v]) {
      normals_[v] = rest.rest[v];
      continue;
    }
    const auto turn = Eigen::Quaternionf::FromTwoVectors(rest.surface[v], surface_normals_[v]);
    normals_[v] = (turn * rest.rest[v]).normalized();
  }
  return normals_;
}

}  // namespace fascia::runtime
