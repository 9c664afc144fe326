#pragma once

#include <array>
#include <optional>
#include <vector>

#include "formats/scene.h"

namespace fascia::formats {

/// A vertex appended to a mesh; its texture coordinates, colours, weights and morphs are interpolated between
/// two earlier vertices.
struct AppendedVertex {
  int a = 0, b = 0;
  double share = 0.0;          ///< of `b`
  std::optional<Vec3> normal;  ///< in the file's axes; otherwise interpolated between `a` and `b`
};

/// The differences between a mesh and its original in the file.
struct MeshExtension {
  int vertices_before = 0;
  std::vector<Triangle> triangles_before;
  std::vector<AppendedVertex> vertices;  ///< in the order in which they are appended
  std::vector<int>
      origin;  ///< #new triangles: the original triangle that each one is or was cut from, -1: none
  bool changed() const { return !vertices.empty(); }
};

/// The extension of an unchanged mesh.
MeshExtension unchanged(const SceneMesh& mesh);

/// Rewrites the document of `scene` after its meshes were extended as described by `extensions` (one per mesh
/// of the file); further meshes are new. Everything else is preserved.
///
/// glTF: accessors of the changed primitives are extended, new meshes get a node of their own. OBJ: vertices
/// are appended, and only faces that were cut are rewritten. PLY and STL keep their bytes. Throws
/// fascia::Error if the document does not match.
void rewrite(Scene& scene, const std::vector<MeshExtension>& extensions);

}  // namespace fascia::formats
