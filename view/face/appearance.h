#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "view/scene.h"

namespace fascia::view {

/// What a file says of how one of its primitives looks.
struct PrimitiveLook {
  std::string material;        ///< its name, may be empty
  std::vector<Vec2> uvs;       ///< one a vertex, the material's own transform applied; or none
  std::vector<Vec3> colours;   ///< one a vertex, sRGB; or none
  Vec3 colour = Vec3::Ones();  ///< sRGB factor
  double opacity = 1.0, roughness = 1.0, metalness = 0.0, normal_strength = 1.0;
  Vec3 glow = Vec3::Zero();
  double alpha_cutoff = -1.0;
  bool is_blended = false, is_two_sided = false;
  bool has_material = false;  ///< whether the file gives one with a colour map or a colour that is no grey
  std::shared_ptr<const Texture> colour_map, normal_map, surface_map;
};

/// The materials, textures and vertex colours of a glTF file, by mesh and primitive.
class Appearance {
 public:
  struct Options {
    int largest_texture = 2048;  ///< pixels; larger ones are halved until they fit
  };

  Appearance() = default;
  /// Reads a GLB file with all it needs inside (rigs are). PNG and JPEG pictures are shown (stb_image);
  /// others are left out, as are maps that cannot be decoded, each with a line in `warnings`.
  static Appearance read(std::span<const uint8_t> glb, const std::string& name, const Options& options);
  static Appearance read(std::span<const uint8_t> glb, const std::string& name) {
    return read(glb, name, Options());
  }

  /// Plain when the file has no such primitive.
  const PrimitiveLook& of(uint32_t mesh, uint32_t primitive) const;
  const std::vector<std::string>& warnings() const { return warnings_; }

 private:
  std::map<std::pair<uint32_t, uint32_t>, PrimitiveLook> looks_;
  std::vector<std::string> warnings_;
};

/// A picture file's bytes as a texture; null when they are no PNG or JPEG.
std::shared_ptr<Texture> decode_texture(std::span<const uint8_t> bytes, bool is_srgb, int largest);

}  // namespace fascia::view
