#pragma once

#include <functional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "gltf/edit/edit.h"

namespace fascia::gltf {

/// Displacements of one primitive's vertices, in its own coordinates.
struct PrimitiveMotion {
  uint32_t mesh = 0, primitive = 0;
  std::vector<Vec3f> displacement;  ///< #vertices
};

/// A primitive as it stands in a pose, in its own coordinates; three floats a vertex.
struct PosedPrimitive {
  uint32_t mesh = 0, primitive = 0;
  std::span<const float> positions;
};

/// Puts the pose's positions and normals in the place of a primitive's own. `posed` is what is to be seen:
/// where default weights of morph targets are on, what they add is taken off again. A primitive without
/// normals gets them.
void set_pose(Edit& edit, const std::vector<PosedPrimitive>& posed);

struct MorphOptions {
  /// What becomes of a shape whose name a mesh has already: the shape gets another name, or takes the old
  /// one's place (its index, and with it every clip that drives it, stays).
  enum class Existing { rename, replace } existing = Existing::rename;
  /// Shapes are directions of a motion, used with weights of either sign, rather than poses at weight 1:
  /// normals are then taken half-way between the two sides.
  bool is_linear = false;
};

/// Where the shapes went in one mesh.
struct MeshTargets {
  uint32_t mesh = 0;
  std::size_t count = 0;  ///< targets the mesh now has
  std::vector<int>
      targets;  ///< by shape: the index of its target in the mesh; -1 where the shape leaves the mesh still
};

/// Appends morph targets to the meshes that `shapes` move: `shapes[s]` holds the motions of the shape called
/// `names[s]`.
///
/// A mesh gets a target for each shape that moves it and no others, with POSITION deltas, NORMAL deltas
/// (normals are added to primitives that have none) and TANGENT deltas where the primitive has tangents.
/// Targets, default weights, names and clips that were there keep their index and values. Lines in `warnings`
/// tell of names that were there. Throws fascia::Error when a motion does not fit the file.
std::vector<MeshTargets> add_morph_targets(Edit& edit, const std::vector<std::string>& names,
                                           const std::vector<std::vector<PrimitiveMotion>>& shapes,
                                           const MorphOptions& options = {},
                                           std::vector<std::string>* warnings = nullptr);

/// The same for shapes that are made one at a time, where all of them at once would take too much memory:
/// `shape(s)` is what the shape called `names[s]` moves, of `meshes` alone.
std::vector<MeshTargets> add_morph_targets(
    Edit& edit, const std::set<uint32_t>& meshes, const std::vector<std::string>& names,
    const std::function<std::vector<PrimitiveMotion>(std::size_t)>& shape, const MorphOptions& options = {},
    std::vector<std::string>* warnings = nullptr);

/// Adds a linear weights channel to `animation` (with its arrays "samplers" and "channels") for every node
/// that shows one of `meshes`. `weight(s, k)` is the weight of shape s at key k of `keys`, `time` the
/// accessor of the keys' times; other targets stay at the node's default weights.
void add_weight_channels(Edit& edit, const std::vector<MeshTargets>& meshes, std::size_t keys,
                         const std::function<float(std::size_t shape, std::size_t key)>& weight,
                         std::size_t time, Json& animation);

}  // namespace fascia::gltf
