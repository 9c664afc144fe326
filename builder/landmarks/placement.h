#pragma once

#include <vector>

#include "builder/landmarks/generic_face.h"

namespace fascia::landmarks {

/// Where the generic head stands on a mesh: a point x of it lies at scale * rotation * x + shift.
struct Placement {
  double scale = 1.0;
  Mat3 rotation = Mat3::Identity();
  Vec3 shift = Vec3::Zero();
  Vec3 operator()(const Vec3& x) const { return scale * (rotation * x) + shift; }
  Vec3 inverse(const Vec3& y) const { return rotation.transpose() * (y - shift) / scale; }
};

/// Places of the generic head that the radial extent of `surface` about the centre of `lump` suggests, best
/// first, at most `count`, no two alike. `cost` receives what is left between the two extents, 0 for none.
struct Guess {
  Placement placement;
  double cost = 0.0;
};
std::vector<Guess> guess_placements(const GenericFace& face, const spatial::SurfaceQuery& surface,
                                    const Ball& lump, int count);

/// Places of the generic head with its nose on what stands out of `samples`, best first, at most `count`: for
/// meshes that are a face alone or a part of a head, on which no sphere tells where the head is.
std::vector<Guess> guess_by_nose(const GenericFace& face, const Neighbours& samples, int count);

/// Brings `start` closer: robust iterative closest points with scale, points to planes, on every `stride`-th
/// point of the face. Besl and McKay 1992; Chen and Medioni 1992. `residual` receives the trimmed mean
/// distance, metres of the generic head.
Placement refine_placement(const GenericFace& face, const Neighbours& target, const Placement& start,
                           int rounds, int stride, double* residual = nullptr);

}  // namespace fascia::landmarks
