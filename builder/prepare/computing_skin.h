#pragma once

#include "builder/prepare/parts.h"

namespace fascia::prepare {

/// The skin that is computed with: without fins and triangles that have no direction.
struct ComputingSkin {
  TriangleMesh mesh;
  std::vector<int> vertex;  ///< surface vertex -> vertex of `mesh`, or -1
};

/// The triangles of `welded` that are set in `is_skin`, mended; `warnings` receives what was mended, how many
/// times, and the vertex of `scene` where it was first.
ComputingSkin computing_skin(const formats::Scene& scene, const WeldedScene& welded,
                             const std::vector<bool>& is_skin, std::vector<std::string>& warnings);

/// Warns of triangles of the skin that `welded` left out because two of their corners are one; `vertex_part`:
/// of each vertex of its surface.
void warn_of_collapsed(const formats::Scene& scene, const WeldedScene& welded,
                       const std::vector<Part>& vertex_part, std::vector<std::string>& warnings);

/// Warns of pieces of `welded` that are too small to be a part of the head and have no part's name.
void warn_of_specks(const formats::Scene& scene, const WeldedScene& welded, const Parts& parts,
                    std::vector<std::string>& warnings);

}  // namespace fascia::prepare
