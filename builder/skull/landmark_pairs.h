#pragma once

#include <map>
#include <string>
#include <vector>

#include "builder/skull/bone_system.h"
#include "builder/skull/skull.h"

namespace fascia::skull {

/// A landmark of the generic and the one of the same name on the head.
struct LandmarkPair {
  const GenericLandmark* generic = nullptr;
  TargetLandmark target;
  Vec3 skin_normal = Vec3::Zero();     ///< on the head, mean over a few millimetres
  Vec3 generic_normal = Vec3::Zero();  ///< on the generic skin; zero without one
  Vec3 direction = Vec3::Zero();       ///< unit, bone to skin, along which the depth is laid off
  double depth = 0;                    ///< scaled, m
  Vec3 bone_target() const { return target.skin - depth * direction; }
};

/// Unit normal of the outer skin near `point`, mean over 4 mm: one triangle of a lip or wrinkle would
/// mislead.
Vec3 mean_skin_normal(const spatial::SurfaceQuery& skin, const Vec3& point);

/// Pairs by name, in alphabetical order. Unknown names are ignored with a warning.
/// Throws Error for coordinates that are not finite or confidences outside (0, 1].
std::vector<LandmarkPair> match_landmarks(const Generic& generic, const Exterior& skin,
                                          const std::map<std::string, TargetLandmark>& given,
                                          const FitOptions& options, std::vector<std::string>& warnings);

/// The scaled table depth of `landmark` under `options`, m.
double scaled_depth(const GenericLandmark& landmark, const FitOptions& options);

/// Throws Error when fewer than four pairs have bone, or they lie on a plane.
void check_spread(const std::vector<LandmarkPair>& pairs);

/// Similarity that carries the generic's skin landmarks to the head's.
Mat4 start_pose(const std::vector<LandmarkPair>& pairs);

/// Depth runs along the generic's own bone-to-skin line as it arrives on this head (by `jacobians`, one a
/// pair), leaning to the skin's normal by `skin_share`.
void aim(std::vector<LandmarkPair>& pairs, const std::vector<Mat3>& jacobians, double skin_share);

/// Deviation along the skin of a landmark with this confidence, m: 0 at 1, without bound towards 0.
double placement_deviation(double confidence);

/// What the pairs with bone say about the bone map.
std::vector<Observation> landmark_observations(const std::vector<LandmarkPair>& pairs);

/// What the skin's normals say about how the bone under it turns: two tangents a pair, asked to arrive at
/// right angles to the head's normal with the length and the course that `jacobians` give them.
/// K. Mardia et al. 1996.
std::vector<TangentObservation> tangent_observations(const std::vector<LandmarkPair>& pairs,
                                                     const std::vector<Mat3>& jacobians, double deviation);

}  // namespace fascia::skull
