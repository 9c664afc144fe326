#pragma once

#include <vector>

#include "anatomy/anatomy.h"
#include "builder/splines/warp.h"

namespace fascia::rigging {

/// Labelled zones of the generic face, carried to this head, as a field over space.
class ZoneField {
 public:
  /// `otherwise` is the value where no zone reaches.
  ZoneField(const std::vector<anatomy::Zone>& zones, double otherwise, const splines::Warp& to_head);

  /// The zones' value at a point on or near the face: inside a polygon its own, fading to `otherwise`
  /// over the zone's falloff; where zones overlap the nearest polygon counts most.
  double operator()(const Vec3& point) const;

 private:
  struct Area {
    Vec3 centre, x, y, normal;
    std::vector<Vec2> outline;
    double value, falloff, depth;
  };
  std::vector<Area> areas_;
  double otherwise_;
};

}  // namespace fascia::rigging
