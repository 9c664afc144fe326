#pragma once

#include <memory>
#include <string>
#include <vector>

#include "formats/scene.h"

namespace fascia::formats {

/// How a mesh of an OBJ file is to look.
struct SceneMaterial {
  std::string name;
  Vec3 colour = Vec3(0.8, 0.8, 0.8);  ///< sRGB, 0..1
  double opacity = 1.0, roughness = 0.6;
  bool has_alpha = false;  ///< whether it, or its colour map by its own alpha, lets through what is behind
  std::shared_ptr<const std::vector<uint8_t>> colour_map, normal_map,
      roughness_map;  ///< PNG or JPEG files, or none
};

struct MaterialLibrary {
  std::vector<SceneMaterial> materials;
  std::vector<int> of_mesh;           ///< one a mesh of the scene, index into `materials`, -1 for none
  std::vector<std::string> warnings;  ///< what was left out, and why
};

/// The materials of an OBJ file: its `mtllib` files and their pictures (PNG and JPEG, which glTF can hold),
/// from the OBJ's own folder. A mesh looks as its first face does. Nothing for files of other kinds, and for
/// libraries that are not there.
MaterialLibrary read_materials(const Scene& scene, const ReadOptions& options = {});

}  // namespace fascia::formats
