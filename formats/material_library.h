#pragma once

#include <string>
#include <string_view>

#include "formats/scene.h"

namespace fascia::formats {

/// The text of the material libraries (`mtllib` lines) that an OBJ file names, from its own folder, one
/// behind the other. What cannot be read is left out with a warning in `scene`.
std::string material_text(Scene& scene, std::string_view obj, const ReadOptions& options);

/// The materials of that text with their pictures (PNG and JPEG, which glTF can hold); others are left out
/// with a warning.
std::vector<SceneMaterial> read_materials(Scene& scene, const std::string& text, const ReadOptions& options);

}  // namespace fascia::formats
