#pragma once

#include <optional>

#include "builder/muscles/hull.h"

namespace fascia::muscles {

/// A geodesic from corner `a` of one hull to corner `b` of another that touches both.
struct Tangent {
  int a = -1, b = -1;
  double length = 0.0;  ///< metres
};

/// On which side of the way from the first hull to the second a hull lies.
enum class HullSide { left, right };

/// The mutual tangent of two hulls that leaves hull `first` on side `first_side` and `second` on
/// `second_side` (thesis section 7.2.3): the same side twice is an outer tangent, different sides an
/// inner one. Found in the plane of the two and walked corner by corner on the surface until both
/// neighbours at either end lie on the side asked for. None when one hull contains the other, and for
/// inner tangents when they overlap.
std::optional<Tangent> mutual_tangent(Carrier& carrier, const Hull& first, const Hull& second,
                                      HullSide first_side, HullSide second_side);

/// A piece of a hull's outline as corner indices in order.
using Arc = std::vector<int>;

/// The arcs between the tangents' ends, each from the right tangent to the left one: towards the other
/// hull and away from it.
struct FacingArcs {
  Arc first_near, first_far, second_near, second_far;
};
FacingArcs facing_arcs(const Hull& first, const Hull& second, const Tangent& left, const Tangent& right);

/// The place a share `fraction` of the way along `arc`, by length; on the chords between corners.
Vec3 along_arc(const Hull& hull, const Arc& arc, double fraction);

/// Length of `arc`, metres.
double arc_length(const Hull& hull, const Arc& arc);

}  // namespace fascia::muscles
