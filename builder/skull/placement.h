#pragma once

#include <array>
#include <span>
#include <vector>

#include "builder/skull/bone_system.h"
#include "builder/skull/clearance.h"
#include "builder/skull/skull.h"

namespace fascia::skull {

/// Cranium, mandible and teeth of the generic as one list of vertices that must stay under the skin.
struct Bones {
  std::vector<Vec3> generic;   ///< vertices of all four meshes, in the order of `first`
  std::array<int, 5> first{};  ///< first vertex of cranium, mandible, upper, lower teeth; their end
  std::vector<SkinOver> over;  ///< of each vertex
  std::vector<std::vector<int>> neighbours;  ///< of each vertex
  bool is_tooth(int vertex) const { return vertex >= first[2]; }
  bool has_teeth() const { return first[2] < first[4]; }
};

Bones gather(const Generic& generic);

/// Bone maps with the same patches, evaluated at the bones' vertices: how far each patch reaches is known.
class VertexMap {
 public:
  VertexMap() = default;
  VertexMap(const Bones& bones, const std::vector<BoneMap::Patch>& pattern);

  /// Where the vertices go. The same as map(bones.generic); `warped` is what the map's warp makes of them.
  std::vector<Vec3> operator()(const Bones& bones, const BoneMap& map, std::span<const Vec3> warped) const;

 private:
  struct Pull {
    int vertex = 0, patch = 0;
    double strength = 0;
  };
  std::vector<Pull> pulls_;  // in order of vertices
};

/// Clearance of each vertex, m: `clearances` of bone, the floor alone of teeth and, as far as those of
/// `patches` that are joints hold them, of joints: skin over them dips into an ear whose depth differs from
/// head to head.
std::vector<double> clearances(const Bones& bones, const std::vector<BoneMap::Patch>& patches,
                               const FitOptions& options);

/// Directions to the generic skin, turned by the rotation of `pose`.
std::vector<Vec3> outward_directions(const Bones& bones, const Mat4& pose);

/// Turns the worst violations of `placed`, spread apart, into observations at and after index `first` of
/// `observations`. Returns false when there is none worth one.
bool add_clearance_observations(ClearanceCheck& check, const Bones& bones, std::span<const Vec3> placed,
                                std::vector<Observation>& observations, size_t first);

/// Teeth keep their shape: when they come through the lips, the whole row and the bone about it step back, by
/// at most `limit` metres. `placed` is where `map` puts the vertices, on return as well; `warped` as for
/// VertexMap.
void retract_teeth(ClearanceCheck& check, const Bones& bones, const VertexMap& vertex_map,
                   std::span<const Vec3> warped, double limit, BoneMap& map, std::vector<Vec3>& placed);

/// Corrects vertex by vertex what is still too near to the skin, counts what is left, and puts the vertices
/// into the meshes of `out`.
void place_meshes(ClearanceCheck& check, const Generic& generic, const Bones& bones,
                  std::vector<Vec3> vertices, FitResult& out);

}  // namespace fascia::skull
