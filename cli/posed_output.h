#pragma once

#include <filesystem>

#include "cli/posing.h"

namespace fascia::cli {

/// The rig's original file with `face`'s pose in the place of its positions and normals; everything else as
/// it came. `face` must be in mesh space.
void write_posed_glb(const std::filesystem::path& rig, const Face& face, const std::filesystem::path& output);

/// The pose as OBJ or PLY in the input's axes and units. Where the rig was built from an OBJ and an OBJ is
/// asked for, that file again with other vertex coordinates; a vertex that does not move keeps its digits.
/// `face` must be in input space.
void write_posed_mesh(const std::filesystem::path& rig, const Face& face,
                      const std::filesystem::path& output);

}  // namespace fascia::cli
