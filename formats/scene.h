#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "formats/files.h"
#include "geometry/mesh.h"
#include "gltf/read/document.h"

/// Mesh files in and out: GLB, glTF, OBJ, PLY, STL. Coordinates are the file's own.
namespace fascia::formats {

enum class FileKind { glb, gltf, obj, ply, stl };

/// One drawable piece of a file: a glTF primitive of a node, an OBJ object, a whole PLY or STL.
struct SceneMesh {
  std::string name;      ///< node or mesh, or object or group; never empty
  std::string material;  ///< material name, empty when there is none
  int mesh = -1;         ///< glTF mesh index, -1 in other formats
  int primitive = -1;    ///< glTF primitive index within it
  int node = -1;         ///< glTF node that carries it
  Mat4 to_file =
      Mat4::Identity();  ///< from the primitive's coordinates to those of `positions` (node transforms)
  std::vector<Vec3>
      positions;  ///< file's axes and units from `Scene::offset`, node transforms and default morphs applied
  std::vector<Triangle> triangles;
  std::vector<Vec2> uvs;                   ///< one a vertex, or none
  std::vector<Vec3> colours;               ///< one a vertex, red, green, blue from 0 to 1, or none
  std::vector<std::vector<int>> polygons;  ///< OBJ and PLY faces before triangulation, by vertex
  std::vector<int> source_vertices;        ///< OBJ: index of each vertex among the file's `v` lines
  std::vector<int> source_textures;        ///< OBJ: the same among its `vt` lines, -1 where it has none
};

/// A file as it was read.
struct Scene {
  std::filesystem::path path;
  FileKind kind = FileKind::glb;
  std::vector<SceneMesh> meshes;  ///< in node order
  gltf::Document document;        ///< of GLB and glTF: self-contained, uncompressed, a mesh for each node
  std::vector<uint8_t> bytes;     ///< of OBJ, PLY and STL: the file itself
  bool is_extended = false;       ///< vertices have been appended since it was read (formats/extend.h)
  /// Where the coordinates of `meshes` have their origin in the file's own. Not 0 for what lies far off (a
  /// scan in map coordinates): single precision would lose its shape.
  Vec3 offset = Vec3::Zero();
  std::vector<std::string> warnings;  ///< what was repaired or left out
};

struct ReadOptions {
  bool allow_outside = false;  ///< files that a glTF names may lie outside its folder
};

/// Reads a mesh file; its kind is told by its first bytes, then by its extension.
///
/// Throws fascia::Error naming the file and what is wrong with it: missing, empty, truncated, not a
/// mesh file, no triangles, an index or accessor out of range, numbers that are not finite, a
/// compression that is not supported.
Scene read(const std::filesystem::path& path, const ReadOptions& options = {});

/// The same from memory; `path` serves for messages and to find external buffers.
Scene read(const std::filesystem::path& path, std::vector<uint8_t> bytes, const ReadOptions& options = {});

}  // namespace fascia::formats
