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

/// Fits a ball to `points` (rig frame, metres) of a connected part; nothing when they are not round, not 6 to
/// 25 mm in radius, or not within 30 mm of the middle `lids` between the corners of the eye.
std::optional<RoundPart> round_part(const std::vector<Vec3>& points, const Vec3& lids);

/// Where an eyeball looks, a unit vector: through its cornea where that stands out of the sphere, else
/// through the pole of a mesh whose triangles run together at the front, else straight ahead (+Z).
///
/// `triangles` index `points`, rig frame.
Vec3 gaze_axis(const Eyeball& ball, const std::vector<Vec3>& points, const std::vector<Triangle>& triangles);

}  // namespace fascia::prepare
