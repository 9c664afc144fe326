#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "gltf/edit/appendix.h"
#include "gltf/read/accessors.h"

namespace fascia::gltf {

/// What shades one primitive at rest: vectors a vertex, in the primitive's own coordinates.
struct ShadedPrimitive {
  std::vector<Vec3f> positions;
  std::vector<Vec3f> normals;             ///< unit; the surface's own where the file has none
  bool has_normals = false;               ///< the file has them
  std::vector<Eigen::Vector4f> tangents;  ///< xyz unit, w the handedness; none where the file has none
  std::vector<Triangle> triangles;
};

/// How normals and tangents of the primitives of one mesh turn as their vertices move. The surface is taken
/// as one across the primitives: vertices of the same position share a normal of the surface.
class MeshShading {
 public:
  explicit MeshShading(std::vector<ShadedPrimitive> primitives);

  const std::vector<ShadedPrimitive>& primitives() const { return primitives_; }

  /// Normals (and tangents, where there are any) of each primitive, #vertices each.
  struct Turned {
    std::vector<std::vector<Vec3f>> normals, tangents;
  };

  /// Normals and tangents once the vertices have moved by `displacements` (by primitive, #vertices each; an
  /// empty list stands still). A normal turns as the surface under it does, by the smallest rotation; a
  /// tangent is carried by the triangles round it, so that it stays the derivative of position by texture
  /// coordinate, and made square with the normal (Lengyel, Foundations of Game Engine Development 2,
  /// section 7.5).
  Turned turned(const std::vector<std::vector<Vec3f>>& displacements) const;

 private:
  std::vector<Vec3f> surface_normals(const std::vector<std::vector<Vec3f>>& positions) const;
  std::vector<std::vector<Vec3f>> moved(const std::vector<std::vector<Vec3f>>& displacements) const;
  std::vector<Vec3f> turned_tangents(std::size_t primitive, const std::vector<Vec3f>& positions,
                                     const std::vector<Vec3f>& normals) const;

  std::vector<ShadedPrimitive> primitives_;
  std::vector<std::vector<uint32_t>>
      place_;  ///< by primitive and vertex: which place of the surface it is at
  std::size_t places_ = 0;
  std::vector<Vec3f> rest_;  ///< normals of the surface at rest, by place
};

/// The shading of mesh `mesh` of a file. Throws fascia::Error naming it when it is not there, a primitive has
/// no POSITION or an accessor is out of bounds.
MeshShading mesh_shading(const tinygltf::Model& model, uint32_t mesh);

}  // namespace fascia::gltf
