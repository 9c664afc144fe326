#pragma once

#include <array>
#include <optional>
#include <vector>

#include "formats/scene.h"

namespace fascia::formats {

/// A vertex appended to a mesh: its texture coordinates, colours, weights and morphs lie between those of two
/// earlier vertices of the mesh.
struct AppendedVertex {
  int a = 0, b = 0;
  double share = 0.0;          ///< of `b`
  std::optional<Vec3> normal;  ///< file's axes; else between those of `a` and `b`
};

/// How a mesh came to differ from the one in its file.
struct MeshExtension {
  int vertices_before = 0;
  std::vector<Triangle> triangles_before;
  std::vector<AppendedVertex> vertices;  ///< in the order in which they follow the others
  std::vector<int>
      origin;  ///< #triangles now: the triangle before that each one is or is a piece of, -1: new
  bool changed() const { return !vertices.empty(); }
};

/// The extension of a mesh that has not changed yet.
MeshExtension unchanged(const SceneMesh& mesh);

/// Writes the file of `scene` anew: its meshes have been extended as `extensions` say (one for each mesh that
/// the file has), and meshes after those are new. Everything else in it stays as it came.
///
/// glTF: accessors of the changed primitives are extended, new meshes get a node of their own. OBJ: vertices
/// are appended and only faces that were cut are written anew. PLY and STL keep their bytes. Throws
/// fascia::Error when the document does not fit.
void rewrite(Scene& scene, const std::vector<MeshExtension>& extensions);

}  // namespace fascia::formats
