#include "builder/skull/landmark_pairs.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>

#include "geometry/alignment.h"
#include "geometry/error.h"
#include "geometry/nearest_names.h"

namespace fascia::skull {

Vec3 mean_skin_normal(const spatial::SurfaceQuery& skin, const Vec3& point) {
  constexpr double radius = 0.004;
  const auto closest = skin.closest(point);
  const Vec3 normal = skin.smooth_normal(closest.surface);
  const Vec3 side = std::abs(normal.y()) < 0.9 ? Vec3::UnitY() : Vec3::UnitZ();
  const Vec3 u = (side - side.dot(normal) * normal).normalized(), v = normal.cross(u);
  Vec3 sum = normal;
  for (int k = 0; k < 8; ++k) {
    const double angle = k * std::numbers::pi / 4;
    const Vec3 beside = closest.position + radius * (std::cos(angle) * u + std::sin(angle) * v);
    sum += skin.smooth_normal(skin.closest(beside).surface);
  }
  return sum.normalized();
}

double scaled_depth(const GenericLandmark& landmark, const FitOptions& options) {
  const auto own = options.depth_scale.find(landmark.name);
  return options.tissue_scale * landmark.depth * (own == options.depth_scale.end() ? 1.0 : own->second);
}

std::vector<LandmarkPair> match_landmarks(const Generic& generic, const Exterior& skin,
                                          const std::map<std::string, TargetLandmark>& given,
                                          const FitOptions& options, std::vector<std::string>& warnings) {
  std::optional<spatial::SurfaceQuery> generic_skin;
  if (options.normal_deviation > 0 && !generic.skin.empty()) generic_skin.emplace(generic.skin);
  std::map<std::string, const GenericLandmark*> known;
  for (const GenericLandmark& landmark : generic.landmarks)
    known[landmark.name] = &landmark;
  std::vector<LandmarkPair> out;
  for (const auto& [name, target] : given) {
    const auto at = known.find(name);
    if (at == known.end()) {
      std::vector<std::string> names;
      for (const GenericLandmark& landmark : generic.landmarks)
        names.push_back(landmark.name);
      warnings.push_back("landmark " + name + " is not one of the generic skull's" +
                         did_you_mean(name, names) + "; it is not used");
      continue;
    }
    if (!target.skin.allFinite()) throw Error("skull: landmark " + name + " is not finite");
    if (!(target.confidence > 0 && target.confidence <= 1))
      throw Error("skull: landmark " + name + " has confidence " + std::to_string(target.confidence) +
                  "; it must be in (0, 1]");
    LandmarkPair pair;
    pair.generic = at->second;
    pair.target = target;
    pair.depth = scaled_depth(*pair.generic, options);
    if (pair.generic->has_bone) {
      pair.skin_normal = mean_skin_normal(skin.surface, target.skin);
      if (generic_skin) pair.generic_normal = mean_skin_normal(*generic_skin, pair.generic->skin);
    }
    out.push_back(pair);
  }
  return out;
}

void check_spread(const std::vector<LandmarkPair>& pairs) {
  std::vector<Vec3> bones;
  for (const LandmarkPair& pair : pairs)
    if (pair.generic->has_bone) bones.push_back(pair.generic->bone);
  if (bones.size() < 4)
    throw Error("skull: only " + std::to_string(bones.size()) +
                " landmarks with bone under them match; at least 4 are needed, such as nasion, pogonion, "
                "zygion_left and zygion_right");
  const double thinnest = principal_axes(scatter(bones)).values[0] / static_cast<double>(bones.size());
  if (std::sqrt(std::max(0.0, thinnest)) < 0.002)
    throw Error(
        "skull: the landmarks lie on a plane, so they say nothing about depth; add one off it, such as "
        "zygion_left or gonion_left");
}

Mat4 start_pose(const std::vector<LandmarkPair>& pairs) {
  std::vector<Vec3> from, to;
  std::vector<double> weights;
  for (const LandmarkPair& pair : pairs) {
    from.push_back(pair.generic->skin);
    to.push_back(pair.target.skin);
    weights.push_back(pair.target.confidence);
  }
  return similarity(from, to, weights);
}

void aim(std::vector<LandmarkPair>& pairs, const std::vector<Mat3>& jacobians, double skin_share) {
  for (size_t i = 0; i < pairs.size(); ++i) {
    LandmarkPair& pair = pairs[i];
    if (!pair.generic->has_bone) continue;
    Vec3 carried = jacobians[i] * (pair.generic->skin - pair.generic->bone);
    carried = carried.norm() > 1e-9 ? Vec3(carried.normalized()) : pair.skin_normal;
    const double share = carried.dot(pair.skin_normal) > 0.2 ? skin_share : 0;
    pair.direction = ((1 - share) * carried + share * pair.skin_normal).normalized();
  }
}

double placement_deviation(double confidence) {
  constexpr double least_confidence = 1e-3;  // metres of deviation say no more than metres
  return 0.004 * (1 / std::max(confidence, least_confidence) - 1);
}

std::vector<Observation> landmark_observations(const std::vector<LandmarkPair>& pairs) {
  std::vector<Observation> out;
  for (const LandmarkPair& pair : pairs) {
    if (!pair.generic->has_bone) continue;
    Observation observation;
    observation.from = pair.generic->bone;
    observation.to = pair.bone_target();
    // A depth laid off beside the right place is off as well, about as much.
    observation.sd =
        std::hypot(std::max(pair.generic->depth_sd, 1e-4), placement_deviation(pair.target.confidence));
    observation.normal = pair.direction;
    observation.slide_sd = placement_deviation(pair.target.confidence);
    out.push_back(observation);
  }
  return out;
}

std::vector<TangentObservation> tangent_observations(const std::vector<LandmarkPair>& pairs,
                                                     const std::vector<Mat3>& jacobians, double deviation) {
  std::vector<TangentObservation> out;
  for (size_t i = 0; i < pairs.size(); ++i) {
    const LandmarkPair& pair = pairs[i];
    if (!pair.generic->has_bone || pair.generic_normal.isZero()) continue;
    const Vec3 u = pair.generic_normal.unitOrthogonal();
    for (const Vec3& tangent : {u, Vec3(pair.generic_normal.cross(u))}) {
      const Vec3 carried = jacobians[i] * tangent;
      const Vec3 flat = carried - carried.dot(pair.skin_normal) * pair.skin_normal;
      out.push_back({pair.generic->bone, tangent, flat, deviation});
    }
  }
  return out;
}

}  // namespace fascia::skull
