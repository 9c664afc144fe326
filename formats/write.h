#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "geometry/mesh.h"

namespace fascia::formats {

/// A surface to write, in the file's coordinates.
struct NamedSurface {
  std::string name;
  TriangleMesh mesh;
  Vec3 colour = Vec3(0.8, 0.8, 0.8);  ///< linear RGB, 0..1; GLB only
};

/// A named bundle of polylines: the fibres of a muscle.
struct NamedLines {
  std::string name;
  std::vector<std::vector<Vec3>> lines;
  Vec3 colour = Vec3(0.7, 0.2, 0.2);
};

/// The contents of one file.
struct Drawing {
  std::vector<NamedSurface> surfaces;
  std::vector<NamedLines> lines;
};

/// Writes a drawing as OBJ, PLY, STL or GLB, by the extension of `path`, atomically.
///
/// OBJ: one `o NAME` with `f` lines per surface, one `g NAME` with `l` lines per bundle. PLY: all surfaces in
/// one list of faces; lines as `edge` elements with an int `muscle`, the bundle's index. STL: surfaces only.
/// GLB: one mesh per surface (TRIANGLES) and one per bundle (LINE_STRIP primitives). Throws fascia::Error for
/// another extension, or for lines into STL.
void write(const std::filesystem::path& path, const Drawing& drawing);

}  // namespace fascia::formats
