#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "formats/files.h"

namespace fascia::formats {

/// A file that a mesh file names beside itself.
struct NamedFile {
  std::string name;                           ///< as it is written there
  std::optional<std::filesystem::path> path;  ///< nothing when it is not there or may not be opened
};

/// The files that `mesh` names and that are read with it: buffers and pictures of a .gltf, material libraries
/// of an .obj and the textures that those name. Files outside its folder are looked at where `outside` allows
/// it. Files are read in pieces, and no further than they make sense. Throws fascia::Error when `mesh` cannot
/// be read.
std::vector<NamedFile> named_files(const std::filesystem::path& mesh, Outside outside = Outside::refused);

}  // namespace fascia::formats
