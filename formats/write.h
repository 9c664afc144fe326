#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "geometry/mesh.h"

namespace fascia::formats {

/// A surface to write, coordinates as they shall stand in the file.
struct NamedSurface {
  std::string name;
  TriangleMesh mesh;
  Vec3 colour = Vec3(0.8, 0.8, 0.8);  ///< linear RGB, 0..1; GLB only
};

/// Polylines to write under one name: the fibres of a muscle.
struct NamedLines {
  std::string name;
  std::vector<std::vector<Vec3>> lines;
  Vec3 colour = Vec3(0.7, 0.2, 0.2);
};

/// What `write` puts into one file.
struct Drawing {
  std::vector<NamedSurface> surfaces;
  std::vector<NamedLines> lines;
};

/// Writes a drawing as OBJ, PLY, STL or GLB, by the extension of `path`, and renames it into place.
///
/// OBJ: one `o NAME` a surface with `f`, one `g NAME` a bundle with `l`. PLY: all surfaces in one list
/// of faces; lines as `edge` elements with an int `muscle`, the bundle's number. STL: surfaces only.
/// GLB: one mesh a surface (TRIANGLES) and one a bundle (LINE_STRIP primitives).
/// Throws fascia::Error for another extension, or for lines into STL.
void write(const std::filesystem::path& path, const Drawing& drawing);

}  // namespace fascia::formats
