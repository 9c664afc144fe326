#pragma once

#include <optional>
#include <string>

#include "builder/landmarks/registration.h"

namespace fascia::landmarks {

/// A face found in a mesh.
struct FoundHead {
  Registration fit;  ///< coarse, a few millimetres off; in the mesh's own axes and units
  const Placement& placement() const { return fit.placement; }
  double likeness = 0.0;       ///< share of the generic face that the mesh follows, see Likeness
  bool is_inside_out = false;  ///< the mesh's triangles face inward
};

/// Finds the head in `mesh`: any pose, size and place; a bust, a whole body, or a face alone.
///
/// Round lumps are the candidates; on each the generic head is turned to where the radial extents agree and
/// drawn close by iterative closest points; then it is bent onto the mesh a little, and how much of the face
/// fits decides. A face alone, or a head cut off somewhere, is found by what stands out of it as a nose does.
/// `hint` says where the head stands, by given landmarks, and spares the search; `up` (unit vector, the
/// mesh's axes) leaves only places whose crown is within 60 degrees of it. Throws fascia::Error when nothing
/// in the mesh is a face; `path` names the file in the message.
FoundHead find_head(const GenericFace& face, const TriangleMesh& mesh, const std::string& path,
                    const std::optional<Placement>& hint = std::nullopt,
                    const std::optional<Vec3>& up = std::nullopt);

}  // namespace fascia::landmarks
