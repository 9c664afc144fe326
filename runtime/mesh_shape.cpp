#include "runtime/mesh_shape.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <array>
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

MeshShape::MeshShape(const rig::Primitive& primitive, const rig::Binding* binding,
                     const rig::Mat4f& input_to_metres, fascia_space space)
    : primitive_(primitive) {
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
  metres_to_space_ = mesh_to_space * to_rig.inverse();
  if (!metres_to_space_.allFinite()) metres_to_space_.setIdentity();
  direction_matrix_ = mesh_to_space.topLeftCorner<3, 3>();
  const Eigen::Matrix3f linear = mesh_to_space.topLeftCorner<3, 3>();
  normal_matrix_ = linear.inverse().transpose() * (linear.determinant() < 0.0F ? -1.0F : 1.0F);
  for (const Vec3f& position : primitive.positions) {
    rest_metres_.push_back(transformed(to_rig, position));
    rest_.push_back(space == FASCIA_SPACE_MESH ? position : transformed(mesh_to_space, position));
  }
  for (uint32_t v = 0; binding != nullptr && v < rest_.size(); ++v) {
    Follower follower{v, static_cast<uint32_t>(nodes_.size()), 0, binding->jaw_weights[v], binding->eye[v]};
    for (size_t i = v * static_cast<size_t>(binding->influences);
         follower.eye == 0 && i < (v + 1) * static_cast<size_t>(binding->influences); ++i) {
      if (binding->weights[i] == 0.0F) continue;
      nodes_.push_back(binding->nodes[i]);
      weights_.push_back(binding->weights[i]);
    }
    follower.end = static_cast<uint32_t>(nodes_.size());
    if (follower.first < follower.end || follower.jaw_share != 0.0F || follower.eye != 0)
      followers_.push_back(follower);
  }
}

const MeshShape::Normals& MeshShape::normals() const {
  std::call_once(normals_once_, [this] {
    normals_.welded = first_at_place(primitive_.positions);
    surface_normals(rest_, normals_.welded, normals_.surface);
    normals_.rest = normals_.surface;
    for (std::size_t v = 0; v < primitive_.normals.size(); ++v)
      normals_.rest[v] = (normal_matrix_ * primitive_.normals[v]).normalized();
  });
  return normals_;
}

const Tangents& MeshShape::tangents() const {
  std::call_once(tangents_once_, [this] {
    tangents_ = std::make_unique<Tangents>(primitive_, rest_, normals().rest, direction_matrix_);
  });
  return *tangents_;
}

const MeshShape::Skinning& MeshShape::skinning() const {
  std::call_once(skinning_once_, [this] {
    for (const Follower& follower : followers_)
      skinning_.influences = std::max(skinning_.influences, follower.end - follower.first);
    skinning_.influences = std::max(4U, (skinning_.influences + 3) / 4 * 4);
    skinning_.nodes.assign(rest_.size() * skinning_.influences, 0);
    skinning_.weights.assign(skinning_.nodes.size(), 0.0F);
    skinning_.jaw.assign(rest_.size(), 0.0F);
    skinning_.eyes.assign(rest_.size(), 0);
    for (const Follower& follower : followers_) {
      skinning_.eyes[follower.vertex] = follower.eye;
      if (follower.eye == 0) skinning_.jaw[follower.vertex] = follower.jaw_share;
      for (uint32_t i = follower.first; i < follower.end; ++i) {
        const std::size_t at = std::size_t{follower.vertex} * skinning_.influences + i - follower.first;
        skinning_.nodes[at] = nodes_[i];
        skinning_.weights[at] = weights_[i];
      }
    }
  });
  return skinning_;
}

void MeshShape::surface_normals(const std::vector<Vec3f>& positions, const std::vector<uint32_t>& welded,
                                std::vector<Vec3f>& normals) const {
  normals.assign(positions.size(), Vec3f::Zero());
  for (const rig::Triangle& triangle : primitive_.triangles) {
    const Vec3f& a = positions[triangle[0]];
    const Vec3f area = (positions[triangle[1]] - a).cross(positions[triangle[2]] - a);
    for (const uint32_t corner : triangle)
      normals[welded[corner]] += area;
  }
  for (std::size_t v = 0; v < normals.size(); ++v)
    normals[v] = welded[v] == v ? normals[v].normalized() : normals[welded[v]];
}

}  // namespace fascia::runtime
