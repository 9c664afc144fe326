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

}  // namespace fascia::bench
