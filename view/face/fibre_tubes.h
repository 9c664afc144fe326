#pragma once

#include <vector>

#include "view/scene.h"

namespace fascia::view {

struct FibreTubeOptions {
  double thinnest = 0.0004, thickest = 0.0014;  ///< radius, m
  double share = 0.62;                          ///< of the way to the next fibre that a fibre fills
  int sides = 6;
  bool has_tendons = true;                                               ///< pale, drawn-out ends
  Vec3 flesh = Vec3(0.66, 0.17, 0.14), tendon = Vec3(0.90, 0.83, 0.74);  ///< sRGB
};

/// Fibres of one muscle as round strands, as thick as their spacing allows so that they close to a sheet;
/// appended to `surface` with a colour a vertex. Points in metres.
void add_fibre_tubes(const std::vector<std::vector<Vec3>>& fibres, const FibreTubeOptions& options,
                     DrawSurface& surface);

}  // namespace fascia::view
