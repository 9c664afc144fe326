#pragma once

#include <optional>
#include <string>
#include <vector>

#include "formats/scene.h"

namespace fascia::prepare {

/// A scene whose triangles can be computed with.
struct Repaired {
  /// The same meshes and vertices, with fewer and turned triangles; nothing when all were sound.
  std::optional<formats::Scene> scene;
  std::vector<std::string> warnings;  ///< what was left out or turned, how many and where the first is
};

/// Finds triangles that would mislead what looks at the surface, in the file's own axes and units:
///
/// - triangles given twice, and whole pieces that lie on others (a second shell, the backs of a double-sided
///   surface) are left out. Of two pieces the first counts, or the one of the mesh named `skin`;
/// - triangles that face against their neighbours are turned, whichever meshes these belong to.
///
/// Vertices count as one where their coordinates agree to a millionth of the whole. No vertex is changed: the
/// user's file keeps what it has, only computing is done on the result.
Repaired repair(const formats::Scene& scene, const std::string& skin = "");

}  // namespace fascia::prepare
