#pragma once

#include <map>
#include <string>
#include <vector>

#include "builder/muscles/depth.h"
#include "geometry/landmarks.h"

namespace fascia::muscles {

/// A net around an orifice: rays that leave its rim at right angles and run straight over the SMAS, so
/// that all points a distance from the rim make a ring.
struct OrificeNet {
  Vec3 centre = Vec3::Zero();
  double step = 0.0;  ///< metres between the points of a ray
  /// Rays counter-clockwise seen from the front, beginning at the subject's left; each from the rim outward.
  std::vector<std::vector<Vec3>> rays;

  /// Point at `distance` from the rim on ray `at`, which counts rays and shares between two; cyclic.
  Vec3 point(double at, double distance) const;

  /// The points of all rays at a distance from the rim.
  struct Ring {
    std::vector<double>
        angles;  ///< at which they are seen about the centre: 0 to the subject's left, π/2 upward
    std::vector<Vec3> points;
  };
  Ring ring(double distance) const;

  /// The ray coordinate whose point on `ring` is seen at `angle`.
  double ray_at(double angle, const Ring& ring) const;
};

/// The net of `orifice` (mouth, eye_left or eye_right) out to `reach` metres. Throws `Error` naming the
/// landmarks it misses.
OrificeNet orifice_net(const Carrier& smas, const Landmarks& landmarks, const std::string& orifice,
                       double reach);

}  // namespace fascia::muscles
