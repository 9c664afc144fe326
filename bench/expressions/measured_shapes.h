#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "geometry/mesh.h"

namespace fascia::bench {

/// A measured expression: displacement of every vertex of one mesh, in the file's units.
struct MeasuredShape {
  std::string name;
  std::vector<Vec3> displacement;
};

/// The morph targets of mesh `mesh` in a glTF file, named by its extras.targetNames.
std::vector<MeasuredShape> measured_shapes(const std::filesystem::path& path, const std::string& mesh);

/// The same of a mesh and primitive by their numbers in the file; none when it has no named targets.
std::vector<MeasuredShape> measured_shapes(const std::filesystem::path& path, size_t mesh, size_t primitive);

}  // namespace fascia::bench
