#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "formats/files.h"
#include "geometry/mesh.h"
#include "gltf/read/document.h"

/// Reading mesh files: GLB, glTF, OBJ, PLY, STL. Coordinates are the file's own.
namespace fascia::formats {

enum class FileKind { glb, gltf, obj, ply, stl };

/// One mesh of a file: a glTF primitive of a node, an OBJ object, or a complete PLY or STL.
struct SceneMesh {
  std::string name;      ///< node or mesh, or object or group; never empty
  std::string material;  ///< material name, empty if there is none
  int mesh = -1;         ///< glTF mesh index, -1 in other formats
  int primitive = -1;    ///< glTF primitive index within it
  int node = -1;         ///< glTF node that carries it
  Mat4 to_file =
      Mat4::Identity();  ///< from the primitive's coordinates to those of `positions` (node transforms)
  std::vector<Vec3>
      positions;  ///< file's axes and units from `Scene::offset`, node transforms and default morphs applied
  std::vector<Triangle> triangles;
  std::vector<Vec2> uvs;                   ///< one per vertex, or none
  std::vector<Vec3> colours;               ///< one per vertex, red, green, blue from 0 to 1, or none
  std::vector<std::vector<int>> polygons;  ///< OBJ and PLY faces before triangulation, by vertex
  std::vector<int> source_vertices;        ///< OBJ: index of each vertex among the file's `v` lines
  std::vector<int> source_textures;        ///< OBJ: the same among its `vt` lines, -1 if it has none
};

/// A mesh file in memory.
struct Scene {
  std::filesystem::path path;
  ReadOptions options;  ///< it was read with
  FileKind kind = FileKind::glb;
  std::vector<SceneMesh> meshes;  ///< in node order
  gltf::Document document;        ///< of GLB and glTF: self-contained, uncompressed, with one mesh per node
  std::vector<uint8_t> bytes;     ///< of OBJ, PLY and STL: the file itself
  bool is_extended = false;       ///< vertices have been appended after reading (formats/extend.h)
  /// Origin of the coordinates of `meshes` in the file's coordinates. Not 0 for meshes far from the origin
  /// (scans in map coordinates), whose shape would be lost in single precision.
  Vec3 offset = Vec3::Zero();
  std::vector<std::string> warnings;  ///< repairs and omissions
};

/// Reads a mesh file; the format is detected from its first bytes, then from its extension.
///
/// Throws fascia::Error naming the file and what is wrong with it: missing, empty, truncated, not a
/// mesh file, no triangles, an index or accessor out of range, numbers that are not finite, a
/// compression that is not supported.
Scene read(const std::filesystem::path& path, const ReadOptions& options = {});

/// The same from memory; `path` is used in messages and to find external buffers.
Scene read(const std::filesystem::path& path, std::vector<uint8_t> bytes, const ReadOptions& options = {});

}  // namespace fascia::formats
