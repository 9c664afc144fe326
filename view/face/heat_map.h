#pragma once

#include <string>
#include <vector>

#include "view/image.h"
#include "view/scene.h"

namespace fascia::view {

/// What a heat map's colours mean.
struct HeatScale {
  std::string title;  ///< with unit
  double least = -1.0, most = 1.0;
  bool is_diverging = true;  ///< blue, grey, red about the middle; else dark to bright
};

/// sRGB colour of a value: Moreland 2009, Diverging color maps for scientific visualization (smooth
/// cool-warm), or Smith & van der Walt 2015's viridis.
Vec3 heat_colour(const HeatScale& scale, double value);

/// Areal strain of the surface at each vertex: area now over area at rest, less one, area-weighted over the
/// triangles around it.
std::vector<double> areal_strain(const std::vector<Vec3>& rest, const std::vector<Vec3>& now,
                                 const std::vector<Triangle>& triangles);

/// Draws a legend with numbers into the lower right corner.
void add_legend(Image& image, const HeatScale& scale);

}  // namespace fascia::view
