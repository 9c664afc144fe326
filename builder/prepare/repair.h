#pragma once

#include <optional>
#include <string>
#include <vector>

#include "formats/scene.h"

namespace fascia::prepare {

/// A scene with repaired triangles.
struct Repaired {
  /// The same meshes and vertices, with removed and flipped triangles; nothing if all were valid.
  std::optional<formats::Scene> scene;
  std::vector<std::string>
      warnings;  ///< what was removed or flipped, the number, and the location of the first
};

/// Repairs a surface for computation, in the file's axes and units:
///
/// - triangles given twice, and whole pieces that lie on others (a second shell, the backs of a double-sided
///   surface) are left out. Of two pieces the first counts, or the one of the mesh named `skin`;
/// - triangles that face against their neighbours are turned, whichever meshes these belong to.
///
/// Vertices are identified if their coordinates agree to a millionth of the extent. No vertex is changed, and
/// the user's file is unaffected.
Repaired repair(const formats::Scene& scene, const std::string& skin = "");

}  // namespace fascia::prepare
