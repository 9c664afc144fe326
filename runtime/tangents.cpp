#include "runtime/tangents.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>

namespace fascia::runtime {
namespace {

/// `direction` made square to the unit `normal` and of length 1; any such direction when it has none.
Vec3f squared(const Vec3f& direction, const Vec3f& normal) {
  const Vec3f square = direction - normal.dot(direction) * normal;
  const float length = square.norm();
  if (length > 1e-12F && std::isfinite(length)) return square / length;
  return normal.unitOrthogonal();
}

/// How the position changes with the first and the second texture coordinate in a triangle; zero where the
/// coordinates span no area.
Eigen::Matrix<float, 3, 2> by_texture(const rig::Primitive& primitive, const rig::Triangle& triangle,
                                      const std::vector<Vec3f>& rest) {
  Eigen::Matrix<float, 3, 2> edges;
  Eigen::Matrix2f texture;
  for (int k = 0; k < 2; ++k) {
    const uint32_t corner = triangle[static_cast<std::size_t>(k) + 1];
    edges.col(k) = rest[corner] - rest[triangle[0]];
    texture.col(k) = primitive.texture[corner] - primitive.texture[triangle[0]];
  }
  const float area = texture.determinant();
  if (!(std::abs(area) > 1e-20F)) return Eigen::Matrix<float, 3, 2>::Zero();
  return edges * texture.inverse();
}

/// Tangents of the texture coordinates.
std::vector<Vec4f> texture_tangents(const rig::Primitive& primitive, const std::vector<Vec3f>& rest,
                                    const std::vector<Vec3f>& normals) {
  std::vector<Vec3f> first(rest.size(), Vec3f::Zero()), second = first;
  for (const rig::Triangle& triangle : primitive.triangles) {
    const Vec3f area = (rest[triangle[1]] - rest[triangle[0]]).cross(rest[triangle[2]] - rest[triangle[0]]);
    const Eigen::Matrix<float, 3, 2> by = by_texture(primitive, triangle, rest);
    for (const uint32_t corner : triangle) {
      first[corner] += area.norm() * by.col(0).stableNormalized();
      second[corner] += area.norm() * by.col(1).stableNormalized();
    }
  }
  std::vector<Vec4f> tangents(rest.size());
  for (std::size_t v = 0; v < rest.size(); ++v) {
    const Vec3f along = squared(first[v], normals[v]);
    const float hand = normals[v].cross(along).dot(second[v]) < 0.0F ? -1.0F : 1.0F;
    tangents[v] << along, hand;
  }
  return tangents;
}

}  // namespace

Tangents::Tangents(const rig::Primitive& primitive, const std::vector<Vec3f>& rest,
                   const std::vector<Vec3f>& normals, const Eigen::Matrix3f& to_space)
    : primitive_(primitive) {
  if (!primitive.tangents.empty()) {
    const float hand = to_space.determinant() < 0.0F ? -1.0F : 1.0F;
    for (std::size_t v = 0; v < rest.size(); ++v) {
      Vec4f tangent;
      tangent << squared(to_space * primitive.tangents[v].head<3>(), normals[v]),
          hand * (primitive.tangents[v].w() < 0.0F ? -1.0F : 1.0F);
      rest_.push_back(tangent);
    }
  } else if (!primitive.texture.empty()) {
    rest_ = texture_tangents(primitive, rest, normals);
  }
  if (rest_.empty()) return;
  for (uint32_t t = 0; t < primitive.triangles.size(); ++t) {
    const rig::Triangle& triangle = primitive.triangles[t];
    Eigen::Matrix<float, 3, 2> edges;
    edges << rest[triangle[1]] - rest[triangle[0]], rest[triangle[2]] - rest[triangle[0]];
    const Eigen::Matrix2f square = edges.transpose() * edges;
    if (!(square.determinant() > 1e-24F * square.trace() * square.trace())) continue;
    const Eigen::Matrix2f inverse = square.inverse();
    const float area = edges.col(0).cross(edges.col(1)).norm();
    for (const uint32_t corner : triangle)
      corners_.push_back({corner, t, area * (inverse * (edges.transpose() * rest_[corner].head<3>()))});
  }
}

void Tangents::at(const std::vector<Vec3f>& positions, const std::vector<Vec3f>& rest,
                  const std::vector<Vec3f>& normals, std::vector<Vec4f>& tangents) const {
  tangents.assign(rest_.size(), Vec4f::Zero());
  if (rest_.empty()) return;
  for (const Corner& corner : corners_) {
    const rig::Triangle& triangle = primitive_.triangles[corner.triangle];
    const Vec3f& origin = positions[triangle[0]];
    tangents[corner.vertex].head<3>() += corner.along.x() * (positions[triangle[1]] - origin) +
                                         corner.along.y() * (positions[triangle[2]] - origin);
  }
  if (positions == rest) {  // to the last bit
    tangents = rest_;
    return;
  }
  for (std::size_t v = 0; v < tangents.size(); ++v) {
    const Vec3f along = squared(tangents[v].head<3>(), normals[v]);
    tangents[v] << along, rest_[v].w();
  }
}

}  // namespace fascia::runtime
