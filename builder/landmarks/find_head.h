#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "builder/landmarks/likeness.h"
#include "builder/landmarks/registration.h"
#include "geometry/for_each.h"

namespace fascia::landmarks {

/// A face found in a mesh.
struct FoundHead {
  Registration fit;  ///< coarse, a few millimetres off; in the mesh's own axes and units
  const Placement& placement() const { return fit.placement; }
  Likeness likeness;
  size_t surface = 0;          ///< which of the surfaces searched
  bool is_inside_out = false;  ///< its triangles face inward
  bool is_doubtful = false;    ///< a low face score: to be inspected
  std::vector<Anchor> eyes;    ///< unlike people's faces: taken for one by these, left and right, the
                               ///< symmetry about them and a nose below
};

/// Prior information about the pose of a head.
struct HeadHints {
  std::vector<Anchor> given;  ///< given landmarks; two or more determine the pose
  std::optional<Vec3> up;     ///< unit vector, the meshes' axes: the crown is within 60 degrees of it
};

/// Finds the head in `surfaces`, which share axes and units: any pose, size and place; a bust, a whole body,
/// or a face alone. They are subsets of one file (all of it, without hair and clothes, mesh by mesh), the
/// most likely first: the search ends with the first conclusive face, otherwise the best is used.
///
/// Candidates come from round lumps, pairs of eyeballs, nose-like protrusions, and the given landmarks, of
/// which two or more determine the pose; where none of these leads to a face, from two eyes, the symmetry
/// about them and a nose or muzzle below (eye_pairs.h). Each candidate is refined by iterative closest
/// points, the generic head is deformed slightly onto the mesh, and the candidates are compared by
/// Likeness::score. Throws fascia::Error if nothing resembles a face and fewer than two landmarks are given;
/// `path` names the file in the message. Candidates are tried side by side by `for_each`; the result does not
/// depend on it.
FoundHead find_head(const GenericFace& face, std::span<const TriangleMesh> surfaces, const std::string& path,
                    const HeadHints& hints = {}, const ForEach& for_each = {});

/// The same for one surface.
FoundHead find_head(const GenericFace& face, const TriangleMesh& mesh, const std::string& path,
                    const HeadHints& hints = {}, const ForEach& for_each = {});

}  // namespace fascia::landmarks
