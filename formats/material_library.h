#pragma once

#include <memory>
#include <string>
#include <vector>

#include "formats/scene.h"

namespace fascia::formats {

/// The material of a mesh of an OBJ file.
struct SceneMaterial {
  std::string name;
  Vec3 colour = Vec3(0.8, 0.8, 0.8);  ///< sRGB, 0..1
  double opacity = 1.0, roughness = 0.6;
  bool has_alpha = false;  ///< whether the material or its colour map is transparent
  std::shared_ptr<const std::vector<uint8_t>> colour_map, normal_map,
      roughness_map;  ///< PNG or JPEG files, or none
};

struct MaterialLibrary {
  std::vector<SceneMaterial> materials;
  std::vector<int> of_mesh;           ///< one per mesh of the scene: index into `materials`, -1 for none
  std::vector<std::string> warnings;  ///< what was ignored, and why
};

/// The materials of an OBJ file: its `mtllib` files and their textures (PNG and JPEG, which glTF can hold),
/// from the OBJ's folder. A mesh gets the material of its first face. Empty for other formats, and for
/// missing libraries.
MaterialLibrary read_materials(const Scene& scene);

}  // namespace fascia::formats
