#pragma once

#include <array>

#include "builder/prepare/prepare.h"
#include "geometry/landmarks.h"

namespace fascia::prepare {

/// All meshes of a scene as one surface in the rig frame, welded along open edges.
struct WeldedScene {
  TriangleMesh surface;
  std::vector<std::vector<int>> vertex_map;  ///< mesh, vertex -> surface vertex
  std::vector<int> triangle_mesh;            ///< surface triangle -> mesh
  std::vector<int> component;                ///< surface triangle -> connected component
  int component_count = 0;
  std::vector<std::array<int, 2>>
      collapsed;  ///< mesh and first vertex of triangles left out: two corners are one
};

/// Joins and welds. Only vertices on open edges are merged, within one glTF mesh, among the objects of an
/// OBJ, and between meshes whose rims run along each other: texture seams close and a head in pieces becomes
/// one, lips and lids that merely touch stay two. A vertex that no triangle uses becomes one with the used
/// one in its place.
WeldedScene weld_scene(const formats::Scene& scene, const Mat4& input_to_metres);

/// What every connected component of `welded` is, and the eyeballs among them: by shape and place first, by
/// name where those leave a choice.
///
/// `landmarks` in the rig frame may be empty: the largest component is then the skin and only names tell
/// the rest apart. Throws fascia::Error when `options.skin` names no mesh.
struct Parts {
  std::vector<Part> component_parts;
  std::optional<Eyeball> eye_left, eye_right;
};
Parts recognise_parts(const formats::Scene& scene, const WeldedScene& welded, const Landmarks& landmarks,
                      const PrepareOptions& options);

/// Adds a warning when a surface beside the skin is as large as it and of its proportions, a second head of
/// which nothing is built, or when it is the skin over again.
void warn_of_other_heads(const formats::Scene& scene, const WeldedScene& welded, const Parts& parts,
                         std::vector<std::string>& warnings);

}  // namespace fascia::prepare
