#pragma once

#include <array>
#include <string>
#include <vector>

#include "formats/scene.h"

namespace fascia::bench {

/// Three vertices of the copy's head mesh and how much of each makes a vertex of the original's.
struct CopiedTo {
  std::array<size_t, 3> vertices;
  Vec3 weights;
};

/// The same head cut into other triangles.
struct RemeshedCopy {
  formats::Scene scene;
  size_t head_vertices = 0;
  std::vector<CopiedTo> head;  ///< #vertices of the original's head mesh
};

/// A copy of `scene` whose mesh `head` is remeshed: `half` has half as many vertices; `uneven` has edges of
/// 0.7 times their length on the subject's left, 1.4 times on the right, and its vertices shaken about by a
/// fifth of an edge. Throws Error for another `kind`.
RemeshedCopy remeshed_copy(const formats::Scene& scene, const std::string& head, const std::string& kind);

/// `values` of the copy's head vertices at the original's.
std::vector<Vec3> carried_over(const RemeshedCopy& copy, const std::vector<Vec3>& values);

}  // namespace fascia::bench
