#include "runtime/bound_mesh.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cstring>
#include <map>

namespace fascia::runtime {
namespace {

Vec3f transformed(const rig::Mat4f& matrix, const Vec3f& point) {
  return matrix.topLeftCorner<3, 3>() * point + matrix.topRightCorner<3, 1>();
}

/// For each vertex the first one at the same place, so that seams do not part the surface's normals.
std::vector<uint32_t> first_at_place(const std::vector<Vec3f>& positions) {
  std::map<std::array<float, 3>, uint32_t> places;
  std::vector<uint32_t> first(positions.size());
  for (uint32_t v = 0; v < positions.size(); ++v)
    first[v] = places.try_emplace({positions[v].x(), positions[v].y(), positions[v].z()}, v).first->second;
  return first;
}

}  // namespace

BoundMesh::BoundMesh(const rig::Primitive& primitive, const rig::Binding* binding, const rig::Mat4f& input_to_metres,
                     fascia_space space)
    : primitive_(primitive), binding_(binding) {
  const rig::Mat4f to_rig = binding != nullptr ? binding->to_rig : input_to_metres;
  rig::Mat4f mesh_to_space = rig::Mat4f::Identity();
  from_metres_.setIdentity();
  if (space == FASCIA_SPACE_MESH) {
    from_metres_ = to_rig.topLeftCorner<3, 3>().inverse();
  } else if (space == FASCIA_SPACE_INPUT) {
    from_metres_ = input_to_metres.topLeftCorner<3, 3>().inverse();
    mesh_to_space = input_to_metres.inverse() * to_rig;
  } else {
    mesh_to_space = to_rig;
  }
  if (!from_metres_.allFinite()) from_metres_.setZero();
  const Eigen::Matrix3f linear = mesh_to_space.topLeftCorner<3, 3>();
  normal_matrix_ = linear.inverse().transpose() * (linear.determinant() < 0.0F ? -1.0F : 1.0F);
  for (const Vec3f& position : primitive.positions) {
    rest_metres_.push_back(transformed(to_rig, position));
    rest_.push_back(space == FASCIA_SPACE_MESH ? position : transformed(mesh_to_space, position));
  }
  positions_ = rest_;
}

Vec3f BoundMesh::displacement(const BonePose& pose, std::size_t vertex) const {
  const rig::Binding& binding = *binding_;
  if (const uint8_t eye = binding.eye[vertex]; eye != 0) {
    const Vec3f arm = rest_metres_[vertex] - pose.eye_centres[eye - 1];
    return pose.eyes[eye - 1] * arm - arm;
  }
  Vec3f sum = Vec3f::Zero();
  for (std::size_t i = vertex * binding.influences; i < (vertex + 1) * binding.influences; ++i)
    sum += binding.weights[i] * pose.displacements[binding.nodes[i]];
  if (const float share = binding.jaw_weights[vertex]; share != 0.0F) {
    const Eigen::Vector3d rest = rest_metres_[vertex].cast<double>();
    sum += share * (pose.jaw * rest - rest).cast<float>();
  }
  return sum;
}

void BoundMesh::follow(const BonePose& pose) {
  if (binding_ == nullptr) return;
  for (std::size_t v = 0; v < positions_.size(); ++v)
    positions_[v] = rest_[v] + from_metres_ * displacement(pose, v);
  normals_stale_ = true;
}

void BoundMesh::surface_normals(const std::vector<Vec3f>& positions, std::vector<Vec3f>& normals) const {
  std::fill(normals.begin(), normals.end(), Vec3f::Zero());
  for (const rig::Triangle& triangle : primitive_.triangles) {
    const Vec3f& a = positions[triangle[0]];
    const Vec3f area = (positions[triangle[1]] - a).cross(positions[triangle[2]] - a);
    for (const uint32_t corner : triangle)
      normals[welded_[corner]] += area;
  }
  for (std::size_t v = 0; v < normals.size(); ++v)
    normals[v] = welded_[v] == v ? normals[v].normalized() : normals[welded_[v]];
}

void BoundMesh::prepare_normals() {
  welded_ = first_at_place(primitive_.positions);
  rest_surface_normals_.resize(rest_.size());
  surface_normals_.resize(rest_.size());
  surface_normals(rest_, rest_surface_normals_);
  rest_normals_ = rest_surface_normals_;
  for (std::size_t v = 0; v < primitive_.normals.size(); ++v)
    rest_normals_[v] = (normal_matrix_ * primitive_.normals[v]).normalized();
  normals_ = rest_normals_;
}

const std::vector<Vec3f>& BoundMesh::normals() {
  if (welded_.empty() && !rest_.empty()) prepare_normals();
  if (!normals_stale_) return normals_;
  normals_stale_ = false;
  surface_normals(positions_, surface_normals_);
  for (std::size_t v = 0; v < normals_.size(); ++v) {
    if (surface_normals_[v] == rest_surface_normals_[v]) {
      normals_[v] = rest_normals_[v];
      continue;
    }
    const auto turn = Eigen::Quaternionf::FromTwoVectors(rest_surface_normals_[v], surface_normals_[v]);
    normals_[v] = (turn * rest_normals_[v]).normalized();
  }
  return normals_;
}

}  // namespace fascia::runtime
