#pragma once

#include "tools/anatomy/head/layout.h"
#include "tools/anatomy/head/skin_surface.h"

namespace fascia::head_maker {

struct DrapeOptions {
  int iterations = 16;  ///< few: many would draw the rings around the openings together
  double step = 0.5;    ///< share of the way to the mean of the neighbours
  double anchor = 0.6;  ///< pull of an anchored node back to its place
};

/// Lay the refined cage on the surface and even it out within the surface: vertices of openings stay (`fixed`
/// 2), anchored nodes stay near their place (1), those of the midline slide in it, those of "neck_end" in its
/// plane.
void drape(const SkinSurface& surface, const std::vector<char>& fixed, HalfHead& head,
           const DrapeOptions& options = {});

/// Area-weighted unit normals of the half; those of the midline lie in the mirror plane.
std::vector<Vec3> half_normals(const HalfHead& head);

}  // namespace fascia::head_maker
