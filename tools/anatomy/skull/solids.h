#pragma once

#include "builder/smas/implicit_function.h"
#include "geometry/mesh.h"

namespace fascia::skull_maker {

/// The larger of two fields (their common inside), rounded over `rounding` mm where they meet. Where `other`
/// is not a number it is left out; where `field` is not, so is the result.
smas::ImplicitFunction intersection(smas::ImplicitFunction field, smas::ImplicitFunction other,
                                    double rounding);

/// The smaller of two fields (both insides), likewise; where only one is a number, that one within 3 mm of
/// its surface.
smas::ImplicitFunction united(smas::ImplicitFunction field, smas::ImplicitFunction other, double rounding);

/// `field` less a hollow that `outside` is the outside of; where `field` is not a number, its solid goes on.
smas::ImplicitFunction carved(smas::ImplicitFunction field, smas::ImplicitFunction outside, double rounding);

/// The outside of what `field` says within `space` mm of it: to be cut from another solid.
smas::ImplicitFunction away_from(smas::ImplicitFunction field, double space);

/// The outside of an ellipsoid whose equator is an opening's edge: `rim` runs along the left half of it from
/// one point of the midplane to the other, `depth` is how far it reaches in. `near` gets points next to it.
smas::ImplicitFunction outside_hollow(const std::vector<Vec3>& rim, double depth, std::vector<Vec3>* near);

/// A plate in the midplane: `outline` (x = 0) around it, thickened by `half_thickness` to either side. `near`
/// gets points next to it.
smas::ImplicitFunction plate(const std::vector<Vec3>& outline, double half_thickness,
                             std::vector<Vec3>* near);

}  // namespace fascia::skull_maker
