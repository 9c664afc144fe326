#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "builder/landmarks/likeness.h"
#include "builder/landmarks/registration.h"

namespace fascia::landmarks {

/// A face found in a mesh.
struct FoundHead {
  Registration fit;  ///< coarse, a few millimetres off; in the mesh's own axes and units
  const Placement& placement() const { return fit.placement; }
  Likeness likeness;
  size_t surface = 0;          ///< which of the surfaces searched
  bool is_inside_out = false;  ///< its triangles face inward
  bool is_doubtful = false;    ///< less like a face than people's are: to be looked at
};

/// What is known of a head before it is looked for.
struct HeadHints {
  std::vector<Anchor> given;  ///< places of landmarks; two and more tell where the head stands
  std::optional<Vec3> up;     ///< unit vector, the meshes' axes: the crown is within 60 degrees of it
};

/// Finds the head in `surfaces`, which share axes and units: any pose, size and place; a bust, a whole body,
/// or a face alone. They are ways to look at one file (all of it, without hair and clothes, mesh by mesh),
/// likely ones first: the search ends with the first face that is beyond doubt, else takes the best.
///
/// Where a head may stand is told by round lumps, by pairs of eyeballs, by what stands out as a nose does,
/// and by the given landmarks, which leave nothing to search where there are two and more. On each such place
/// the generic head is drawn close by iterative closest points, then bent onto the mesh a little, and how
/// face-like that is (Likeness::score) decides, the same for all. Throws fascia::Error when nothing is like a
/// face and fewer than two landmarks are given; `path` names the file in the message.
FoundHead find_head(const GenericFace& face, std::span<const TriangleMesh> surfaces, const std::string& path,
                    const HeadHints& hints = {});

/// The same for one surface.
FoundHead find_head(const GenericFace& face, const TriangleMesh& mesh, const std::string& path,
                    const HeadHints& hints = {});

}  // namespace fascia::landmarks
