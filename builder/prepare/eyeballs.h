#pragma once

#include <optional>
#include <string>
#include <vector>

#include "builder/prepare/prepare.h"

namespace fascia::prepare {

/// Least-squares sphere through `points`; `rms` receives the radial residual, metres.
Eyeball fit_sphere(const std::vector<Vec3>& points, double* rms);

/// A part that may be an eyeball, or a shell over one.
struct RoundPart {
  Eyeball ball;
  double coverage = 0.0;  ///< share of the directions from the centre in which it has points: 1 a whole ball,
                          ///< 0.5 and less a shell
};

/// Fits a ball to `points` (rig frame, metres) of a connected part; nothing when they are not round, not of
/// the size of an eyeball behind a palpebral fissure `width` metres wide (0.2 to 1.1 of it in radius), not
/// within its width of the middle `lids` between the corners of the eye, or round about a place before the
/// lids, as eyes that are painted on a hollow are.
std::optional<RoundPart> round_part(const std::vector<Vec3>& points, const Vec3& lids, double width = 0.030);

/// A globe for an eye that is a flat or hollow plate in the fissure: as far behind the plate as the front of
/// a globe of that size would be. `plate` bounds it, `width` is the fissure's, metres.
Eyeball globe_behind(const Bounds& plate, double width);

/// Where an eyeball looks, a unit vector: through its cornea where that stands out of the sphere, else
/// through the pole of a mesh whose triangles run together at the front, else straight ahead (+Z).
///
/// `triangles` index `points`, rig frame.
Vec3 gaze_axis(const Eyeball& ball, const std::vector<Vec3>& points, const std::vector<Triangle>& triangles);

}  // namespace fascia::prepare
