#include "runtime/bound_mesh.h"
#include "geometry/alignment.h"

#include <Eigen/Geometry>
#include <algorithm>

namespace fascia::runtime {

void BoundMesh::change_shape(const MeshShape& shape, const BonePose& pose, bool fades) {
  shape_ = &shape;
  if (!is_wanted_) return;
  const std::vector<Vec3f> before = positions_;
  std::copy(shape_->rest().begin(), shape_->rest().end(), positions_.begin());
  held_.clear();
  follow(pose);
  if (!fades) return;
  held_ = before;
  for (std::size_t v = 0; v < positions_.size(); ++v)
    held_[v] -= positions_[v];
  std::copy(before.begin(), before.end(), positions_.begin());
}

void BoundMesh::let_go() {
  std::fill(held_.begin(), held_.end(), Vec3f::Zero());
}

void BoundMesh::follow(const BonePose& pose, float held) {
  if (!is_wanted_) return;
  const bool fades = held > 0.0F && !held_.empty();
  if (!held_.empty()) std::copy(shape_->rest().begin(), shape_->rest().end(), positions_.begin());
  if (!fades) held_.clear();  // keeps its memory
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
  for (std::size_t v = 0; fades && v < positions_.size(); ++v)
    positions_[v] += held * held_[v];
  normals_stale_ = tangents_stale_ = true;
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
    const auto turn = least_rotation(rest.surface[v], surface_normals_[v]);
    normals_[v] = (turn * rest.rest[v]).normalized();
  }
  return normals_;
}

const std::vector<Vec4f>& BoundMesh::tangents(const BonePose& pose) {
  const std::vector<Vec3f>& normals = this->normals(pose);
  if (!tangents_stale_) return tangents_;
  tangents_stale_ = false;
  shape_->tangents().at(positions_, shape_->rest(), normals, tangents_);
  return tangents_;
}

}  // namespace fascia::runtime
