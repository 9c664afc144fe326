#pragma once

#include <cstdint>
#include <vector>

#include "rig/read/read.h"

namespace fascia::runtime {

using rig::Vec2f;
using rig::Vec3f;
using rig::Vec4f;

/// Tangents of a surface that moves. At rest they are the file's own, or those of its texture coordinates
/// (the direction in which the first coordinate grows, averaged over the triangles about a vertex; Lengyel
/// 2001, Computing tangent space basis vectors for an arbitrary mesh); moved ones go with the triangles that
/// they lie in.
class Tangents {
 public:
  /// `rest` and `normals` #vertices, of the primitive in the space wanted; `to_space` takes directions of the
  /// file there.
  Tangents(const rig::Primitive& primitive, const std::vector<Vec3f>& rest, const std::vector<Vec3f>& normals,
           const Eigen::Matrix3f& to_space);

  /// Tangents (xyz, unit, square to `normals`, and the handedness) at `positions`, #vertices each; none when
  /// the file gives none.
  void at(const std::vector<Vec3f>& positions, const std::vector<Vec3f>& rest,
          const std::vector<Vec3f>& normals, std::vector<Vec4f>& tangents) const;

 private:
  /// A vertex's tangent in one triangle at it: `along` times its two edges from corner 0.
  struct Corner {
    uint32_t vertex, triangle;
    Vec2f along;
  };
  const rig::Primitive& primitive_;
  std::vector<Vec4f> rest_;  ///< #vertices, or none
  std::vector<Corner> corners_;
};

}  // namespace fascia::runtime
