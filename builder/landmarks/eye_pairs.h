#pragma once

#include <vector>

#include "builder/landmarks/placement.h"
#include "builder/landmarks/searched_surface.h"

namespace fascia::landmarks {

/// What may be the two eyes of a creature or another drawn head, and which way this faces; the frame and
/// unit of the mesh.
struct EyePair {
  Vec3 right, left, middle;  ///< centres of the balls or holes; between them
  Vec3 up, forward;          ///< unit vectors
  double apart = 0.0;        ///< the distance of the two
  bool are_balls = false;    ///< eyeballs; else sockets, holes in the mesh
  bool has_nose = false;     ///< a nose or a muzzle stands out below them, and nothing as much above
};

/// The pairs of balls, and where none of these has a nose the pairs of holes that do, in `surface`: of one
/// size, open to one side, and what is about them its own mirror image.
std::vector<EyePair> eye_pairs(SearchedSurface& surface);

/// Whether the generic head so placed has its eyes about where `pair` is.
bool has_its_eyes(const GenericFace& face, const Placement& placement, const EyePair& pair);

/// Places of the generic head with its eyes, `held`, in those of `pair`: for heads that resemble people's in
/// nothing else.
std::vector<Guess> guess_by_eye_pair(const GenericFace& face, const EyePair& pair);

}  // namespace fascia::landmarks
