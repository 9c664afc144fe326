#pragma once

#include <span>
#include <vector>

#include "geometry/mesh.h"

namespace fascia::view {

/// Smooth normals of one surface that a file keeps in several meshes: heads are often cut up by material or
/// by group, and must not show the cuts.
class JointNormals {
 public:
  /// `rest` and `triangles`: of each mesh, in metres at rest. Vertices at one place, in one mesh or in
  /// several, are one where their meshes face the same way there; the two sides of a doubled sheet stay
  /// apart.
  JointNormals(const std::vector<std::vector<Vec3>>& rest,
               const std::vector<std::vector<Triangle>>& triangles);

  /// Unit normals of each mesh, one a vertex; `positions` as `rest`, in any pose.
  std::vector<std::vector<Vec3>> of(const std::vector<std::vector<Vec3>>& positions) const;

 private:
  std::vector<Vec3> joined(const std::vector<std::vector<Vec3>>& lists) const;

  std::vector<Triangle> triangles_;  ///< of all meshes, their vertices counted on from mesh to mesh
  std::vector<int> seams_;           ///< see `seams_of`
};

}  // namespace fascia::view
