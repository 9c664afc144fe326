#pragma once

#include <functional>
#include <vector>

#include "builder/smas/marching_triangles.h"
#include "builder/smas/reach.h"
#include "builder/smas/samples.h"

namespace fascia::smas {

/// A point between the layers: where its skin is, and how far skin and bone are.
struct Lie {
  spatial::ClosestPoint skin;
  double under_skin = 0.0, over_bone = 0.0;
  bool between() const { return under_skin > 0.0 && over_bone > 0.0; }
};

/// The two layers that the SMAS lies between.
struct Layers {
  const spatial::SurfaceQuery& skin;
  const Bones& bones;
  double clearance;  ///< metres kept to both where there is room
  double range;      ///< depth within which bone is looked for, metres
  /// Outward direction at a point of `skin`; at its rims that of the whole skin, which goes on there.
  std::function<Vec3(const SurfacePoint&)> outward;

  Lie lie(const Vec3& point) const;
  bool clear(const Lie& lie) const { return lie.under_skin >= clearance && lie.over_bone >= clearance; }
  /// Moves a point that is too near to one layer away from it, at most to the middle between the two.
  Lie move_between(Vec3* point) const;
};

/// Moves all vertices of `surface` between the layers, mends the triangles that this spoilt without leaving
/// them again, and drops from the border what cannot be mended. Returns how its vertices lie.
std::vector<Lie> order_layers(const Layers& layers, MarchingResult* surface);

}  // namespace fascia::smas
