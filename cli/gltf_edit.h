#pragma once

#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <vector>

#include "rig/model/rig.h"
#include "rig/write/write.h"

namespace fascia::cli {

/// Changes to a glTF file that leave everything else in it as it came: data are appended, never moved.
class GltfEdit {
 public:
  explicit GltfEdit(rig::GltfSource source);

  /// Appends an accessor of `values` (float, `width` numbers each) and returns its index. `bounds` adds
  /// min and max, which POSITION and animation inputs need.
  size_t add_floats(std::span<const float> values, int width, bool bounds, int target = 0);

  /// Appends a sparse accessor of `count` VEC3 that are zero but at `indices` (ascending).
  size_t add_sparse(size_t count, std::span<const uint32_t> indices, std::span<const rig::Vec3f> values);

  /// The primitive's JSON.
  nlohmann::ordered_json& primitive(uint32_t mesh, uint32_t index);

  nlohmann::ordered_json json;

  /// The file as GLB.
  std::vector<uint8_t> bytes() const;

 private:
  size_t add_view(const void* data, size_t size, int target);
  std::vector<uint8_t> binary_;
};

/// Displacements of one primitive's vertices, in its own coordinates.
struct PrimitiveMotion {
  uint32_t mesh = 0, primitive = 0;
  std::vector<rig::Vec3f> displacement;  ///< #vertices
};

/// A primitive as it stands in a pose, in its own coordinates; three floats a vertex.
struct PosedPrimitive {
  uint32_t mesh = 0, primitive = 0;
  std::span<const float> positions, normals;
};

/// Puts the pose's positions, and normals where the primitive has them, in the place of its own.
void set_pose(GltfEdit& edit, const PosedPrimitive& posed);

/// Appends one morph target a motion to the meshes the motions name, with `names` in extras.targetNames.
/// `shapes[s]` holds the motions of target s; a primitive that a target does not move gets zeros. Targets the
/// mesh had before stay first.
void add_morph_targets(GltfEdit& edit, const std::vector<std::string>& names,
                       const std::vector<std::vector<PrimitiveMotion>>& shapes);

}  // namespace fascia::cli
