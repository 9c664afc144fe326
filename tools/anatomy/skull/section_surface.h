#pragma once

#include <memory>
#include <vector>

#include "builder/smas/implicit_function.h"
#include "tools/anatomy/skull/figures.h"

namespace fascia::skull_maker {

struct SectionSurfaceOptions {
  int neighbours = 44;         ///< points that a local spline is fitted to
  double covered = 0.45;       ///< part of a patch's radius within which points need no patch of their own
  double smoothing = 2e-3;     ///< of the local splines, in their own units
  double normal_weight = 0.2;  ///< of normals against positions when smoothing
  double blend_width = 12.0;   ///< mm from the midplane over which the field meets its mirror image
};

/// A signed field (about millimetres, negative inside), exactly symmetric about x = 0, whose zero set is
/// the surface through `points` of the left half and their mirror images.
///
/// Local polyharmonic splines of values and gradients (Hermite data) on overlapping balls, blended by a
/// partition of unity: Ohtake, Belyaev, Alexa, Turk, Seidel, "Multi-level partition of unity implicits",
/// 2003; Macedo, Gois, Velho, "Hermite radial basis functions implicits", 2011. Outside all balls the
/// field is not a number, which the mesher takes for "no surface here".
smas::ImplicitFunction section_surface(const std::vector<OrientedPoint>& points,
                                       const SectionSurfaceOptions& options = {});

}  // namespace fascia::skull_maker
