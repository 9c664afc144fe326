#pragma once

#include <vector>

#include "builder/landmarks/registration.h"

namespace fascia::landmarks {

/// Relief of `samples` at `points`, which face along `normals`: the distance along the normal from the mean
/// of the samples within a radius, relative to that radius. It is invariant to the face's proportions: noses
/// protrude from any face, eyes and mouths are recessed. The radii are 12 and 24 mm of `scale` (metres of the
/// generic head in the samples' unit). NaN where there are too few samples.
Relief relief(const Neighbours& samples, const std::vector<Vec3>& points, const std::vector<Vec3>& normals,
              double scale);

/// The face score of a fit, and its factors.
struct Likeness {
  double share = 0.0;     ///< of the face's points with a close surface of compatible normal
  double on_mesh = 0.0;   ///< the same among the points that do not hang over the mesh's edge
  double coverage = 0.0;  ///< share of the points of eyes, nose and mouth that do not hang over it
  double relief = 0.0;    ///< correlation, -1 to 1, of the two surfaces' relief over the face
  double symmetry = 0.0;  ///< 1: the fit bent both sides alike; less: by how much it did not
  /// The product, comparable between meshes, heads and poses: 0 no face, 1 the generic face itself.
  double score() const;
};
Likeness likeness(const GenericFace& face, const Registration& fit, const Neighbours& samples);

}  // namespace fascia::landmarks
