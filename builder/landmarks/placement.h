#pragma once

#include <vector>

#include "builder/landmarks/generic_face.h"
#include "geometry/for_each.h"

namespace fascia::landmarks {

/// Pose of the generic head on a mesh: its point x is mapped to scale * rotation * x + shift.
struct Placement {
  double scale = 1.0;
  Mat3 rotation = Mat3::Identity();
  Vec3 shift = Vec3::Zero();
  Vec3 operator()(const Vec3& x) const { return scale * (rotation * x) + shift; }
  Vec3 inverse(const Vec3& y) const { return rotation.transpose() * (y - shift) / scale; }
};

/// A correspondence between a point of the generic head and a known point of the target.
struct Anchor {
  Vec3 generic, target;  ///< generic head's frame; mesh's frame
  double weight = 1.0;   ///< of a correspondence found is at most 1
};

/// Places of the generic head that the radial extent of `surface` about the centre of `lump` suggests, best
/// first, at most `count`, no two alike. `cost` receives what is left between the two extents, 0 for none.
struct Guess {
  Placement placement;
  double cost = 0.0;
  std::vector<Anchor> held;  ///< what led to it, where that was known places: a pair of eyeballs
};
std::vector<Guess> guess_placements(const GenericFace& face, const spatial::SurfaceQuery& surface,
                                    const Ball& lump, int count);

/// Places of the generic head with its nose on what stands out of `samples`, best first, at most `count`: for
/// meshes that are a face alone or a part of a head, on which no sphere tells where the head is.
std::vector<Guess> guess_by_nose(const GenericFace& face, const Neighbours& samples, int count,
                                 const ForEach& for_each = {});

/// Places of the generic head with its eyes in a pair of balls of `mesh` of one size, best first, at most
/// `count`; `extent` is the size of what `samples` were taken of.
std::vector<Guess> guess_by_eyes(const GenericFace& face, const TriangleMesh& mesh, const Neighbours& samples,
                                 int count);

/// Places that a few known points leave: one for three and more that are not in a line, those about their
/// line for two and more, best first, at most `count`; none for fewer.
std::vector<Guess> guess_by_anchors(const GenericFace& face, const std::vector<Anchor>& anchors,
                                    const Neighbours& samples, int count);

/// Mean distance of the face's points `points` from the samples that face as they do, in metres of the
/// generic head, none counting more than 12 mm.
double distance_from(const GenericFace& face, const std::vector<size_t>& points, const Neighbours& samples,
                     const Placement& placement);

/// Indices of every `stride`-th point of the generic face, those outside it not counted.
std::vector<size_t> some_face_points(const GenericFace& face, size_t stride);

/// Brings `start` closer: robust iterative closest points with scale, points to planes, on every `stride`-th
/// point of the face. Besl and McKay 1992; Chen and Medioni 1992. `residual` receives the trimmed mean
/// distance, metres of the generic head. `anchors` are held to, all together as much as the face itself.
Placement refine_placement(const GenericFace& face, const Neighbours& target, const Placement& start,
                           int rounds, int stride, double* residual = nullptr,
                           const std::vector<Anchor>& anchors = {});

}  // namespace fascia::landmarks
