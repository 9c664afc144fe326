#pragma once

#include "builder/smas/implicit_function.h"
#include "geometry/mesh.h"

namespace fascia::skull_maker {

/// A line of points in order that the edges of a mesh should follow.
using Rim = std::vector<Vec3>;

struct CreaseOptions {
  int passes = 5;             ///< of moving onto rims and to creases
  double rim_angle = 16.0;    ///< degrees, that moving to the rims may bring a triangle down to
  double least_angle = 32.0;  ///< the same for moving to creases
};

/// Makes the edges of `half` follow the creases of the surface of `field`: vertices near a rim go onto it and
/// stay, the others move to where the surface's tangent planes around them meet, and edges are flipped to lie
/// closer to the surface. Vertices at x = 0 stay. No triangle gets an angle below what `options` allow that
/// it had not before.
///
/// Based on: Y. Ohtake, A. Belyaev, "Dual/primal mesh optimization for polygonized implicit surfaces", 2002.
void follow_creases(const smas::ImplicitFunction& field, const std::vector<Rim>& rims,
                    const std::vector<double>& sizes, const CreaseOptions& options, TriangleMesh* half);

}  // namespace fascia::skull_maker
