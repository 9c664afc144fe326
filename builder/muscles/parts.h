#pragma once

#include <optional>

#include "builder/muscles/depth.h"
#include "builder/muscles/orifice.h"

namespace fascia::muscles {

/// A region on this head, with its bone where it is on one.
struct Place {
  anatomy::Attachment on = anatomy::Attachment::smas;
  std::vector<Vec3> polygon;
  const spatial::SurfaceQuery* bone = nullptr;  ///< null when not on a bone of this head
  Vec3 centre() const;
};

/// A muscle on its way from the generic anatomy to this head.
struct Course {
  const anatomy::Muscle& muscle;
  Place origin, insertion;
  std::vector<Vec3> waypoints;
};

/// Fibres on the SMAS at their depth: straps, fans and sheets by one construction.
std::vector<Fibre> lay_on_smas(Carrier& smas, const Depths& depths, const Course& course, const Options& options);

/// Fibres straight through space from region to region by the waypoints, kept out of the bones.
std::vector<Fibre> lay_through_space(const Carrier& smas, const Course& course,
                                     const std::vector<const spatial::SurfaceQuery*>& bones, const Options& options);

/// Rings at constant distance from an orifice.
std::vector<Fibre> lay_rings(const Depths& depths, const OrificeNet& net, const anatomy::Muscle& muscle,
                             const Options& options);

/// Fibres across those rings, from the skin outside to the lining inside.
std::vector<Fibre> lay_compressors(const Depths& depths, const OrificeNet& net, const anatomy::Muscle& muscle,
                                   const Options& options);

}  // namespace fascia::muscles
