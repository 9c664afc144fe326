#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "geometry/mesh.h"

/// Mesh files in and out: GLB, glTF, OBJ, PLY, STL. Coordinates are the file's own.
namespace fascia::formats {

enum class FileKind { glb, gltf, obj, ply, stl };

/// One drawable piece of a file: a glTF primitive of a node, an OBJ object, a whole PLY or STL.
struct SceneMesh {
  std::string name;                 ///< node or mesh, or object or group; never empty
  std::string material;             ///< material name, empty when there is none
  int mesh = -1;                    ///< glTF mesh index, -1 in other formats
  int primitive = -1;               ///< glTF primitive index within it
  int node = -1;                    ///< glTF node that carries it
  Mat4 to_file = Mat4::Identity();  ///< from the primitive's coordinates to the file's (node transforms)
  std::vector<Vec3> positions;      ///< in the file's axes and units, node transforms applied
  std::vector<Triangle> triangles;
  std::vector<Vec2> uvs;                   ///< one a vertex, or none
  std::vector<std::vector<int>> polygons;  ///< OBJ and PLY faces before triangulation, by vertex
  std::vector<int> source_vertices;        ///< OBJ: index of each vertex among the file's `v` lines
};

/// A glTF file as one JSON text and one binary chunk, everything external brought in.
struct GltfDocument {
  std::string json;
  std::vector<uint8_t> binary;
};

/// A file as it was read.
struct Scene {
  std::filesystem::path path;
  FileKind kind = FileKind::glb;
  std::vector<SceneMesh> meshes;  ///< in node order
  GltfDocument document;          ///< of GLB and glTF
  std::vector<uint8_t> bytes;     ///< of OBJ, PLY and STL: the file itself
};

/// Reads a mesh file; its kind is told by its first bytes, then by its extension.
///
/// Throws fascia::Error naming the file and what is wrong with it: missing, empty, truncated, not a
/// mesh file, no triangles, an index or accessor out of range, numbers that are not finite, a
/// compression that is not supported.
Scene read(const std::filesystem::path& path);

/// The same from memory; `path` serves for messages and to find external buffers.
Scene read(const std::filesystem::path& path, std::vector<uint8_t> bytes);

/// A whole file's bytes. Throws fascia::Error when it cannot be read.
std::vector<uint8_t> read_bytes(const std::filesystem::path& path);

/// Writes `bytes` beside `path` and renames it into place, so that nothing is lost half-way.
/// Throws fascia::Error when it cannot.
void write_bytes(const std::filesystem::path& path, const void* bytes, size_t size);
void write_text(const std::filesystem::path& path, const std::string& text);

}  // namespace fascia::formats
