#pragma once

#include <vector>

#include "builder/landmarks/registration.h"

namespace fascia::landmarks {

/// Relief of `samples` at `points`, which face along `normals`: along the normal, the distance from the
/// middle of the samples within a radius, as a share of that radius. It is what is left of a face when its
/// proportions are taken away: noses stand out of any face, eyes and mouths lie in. The radii are 12 and 24
/// mm of `scale` (metres of the generic head in the samples' unit). NaN where there are too few samples to
/// tell.
Relief relief(const Neighbours& samples, const std::vector<Vec3>& points, const std::vector<Vec3>& normals,
              double scale);

/// How face-like a fit is.
struct Likeness {
  double share = 0.0;     ///< of the face's points: their surface is near and faces as it should
  double on_mesh = 0.0;   ///< the same among the points that do not hang over the mesh's edge
  double coverage = 0.0;  ///< share of the points of eyes, nose and mouth that do not hang over it
  double relief = 0.0;    ///< correlation, -1 to 1, of the two surfaces' relief over the face
  double symmetry = 0.0;  ///< 1: the fit bent both sides alike; less: by how much it did not
  /// All of it in one number that can be compared between meshes, heads and places: 0 nothing, 1 the generic
  /// face itself.
  double score() const;
};
Likeness likeness(const GenericFace& face, const Registration& fit, const Neighbours& samples);

}  // namespace fascia::landmarks
