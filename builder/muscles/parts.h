#pragma once

#include <string>
#include <vector>

#include "builder/muscles/depth.h"
#include "builder/muscles/orifice.h"

namespace fascia::muscles {

/// A region on this head, with its bone where it is on one.
struct Place {
  anatomy::Attachment on = anatomy::Attachment::smas;
  std::vector<Vec3> polygon;
  const spatial::SurfaceQuery* bone = nullptr;  ///< null when not on a bone of this head
  bool is_sketched = false;                     ///< drawn by the user: stays where it is
  Vec3 centre() const;
};

/// A muscle on its way from the generic anatomy to this head.
struct Course {
  anatomy::Muscle muscle;  ///< with the user's changes
  Place origin, insertion;
  std::vector<Vec3> waypoints;
};

/// The region that a sketch stands for, corners in order. `what` names muscle and end for errors.
std::vector<Vec3> sketched_region(const Sketch& sketch, const Place& place, const Inputs& inputs,
                                  const spatial::SurfaceQuery& smas, const std::string& what);

/// The nodes of both sides: where the insertions of `courses` on the modiolus lie in the middle, those drawn
/// together to `radius` metres about it, but for sketched ones. Sides on which none inserts have none, and
/// with a radius of 0 each stays at its own place.
std::vector<Modiolus> gather_modioli(const Carrier& smas, std::vector<Course>& courses, double radius);

/// Fibres on the SMAS at their depth: straps, fans and sheets by one construction. None when an opening of
/// the SMAS bars the way of one of them, or they cannot be laid without crossing. A region that had to be
/// drawn in for want of a hull is added to `warnings`.
std::vector<Fibre> lay_on_smas(Carrier& smas, const Depths& depths, const Course& course,
                               const Options& options, std::vector<std::string>& warnings);

/// Fibres straight through space from region to region by the waypoints, kept out of the bones.
std::vector<Fibre> lay_through_space(const Carrier& smas, const Course& course,
                                     const std::vector<const spatial::SurfaceQuery*>& bones,
                                     const Options& options);

/// Rings at constant distance from an orifice. Those of the mouth draw together in the node at its corner.
std::vector<Fibre> lay_rings(const Depths& depths, const OrificeNet& net, const anatomy::Muscle& muscle,
                             const std::vector<Modiolus>& modioli, const Options& options);

/// Fibres across those rings, from the skin outside to the lining inside.
std::vector<Fibre> lay_compressors(const Depths& depths, const OrificeNet& net, const anatomy::Muscle& muscle,
                                   const Options& options);

}  // namespace fascia::muscles
