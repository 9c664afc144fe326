#include "builder/skull/head_warp.h"

#include <algorithm>
#include <cmath>

#include "builder/skull/teeth.h"

namespace fascia::skull {
namespace {

constexpr double bone_sd = 0.0005;  // m
constexpr double smoothing = 100;
constexpr double least_distance = 0.003;  // m; nearer points would say the same twice

// Landmarks carried over still lie on the skin, so regions should follow them; those that the head lacks do
// not.
double skin_deviation(double confidence) {
  return std::hypot(bone_sd, confidence > 0.05 ? 0.004 * (1 - confidence) : placement_deviation(confidence));
}

}  // namespace

HeadWarp::HeadWarp(const Generic& generic, const std::vector<LandmarkPair>& pairs) {
  const auto add = [&](const Vec3& from, double sd, int pair) {
    for (const Observation& other : observations_)
      if ((other.from - from).norm() < least_distance) return;
    Observation observation;
    observation.from = from;
    observation.sd = sd;
    observations_.push_back(observation);
    skin_pairs_.push_back(pair);
  };
  for (const LandmarkPair& pair : pairs)
    if (pair.generic->has_bone) add(pair.generic->bone, bone_sd, -1);
  for (size_t i = 0; i < pairs.size(); ++i)
    add(pairs[i].generic->skin, skin_deviation(pairs[i].target.confidence), static_cast<int>(i));
  for (const TriangleMesh* mesh : {&generic.cranium, &generic.mandible})
    for (const Vec3& point : symmetric_points(*mesh, mesh == &generic.cranium ? 50 : 25))
      if (std::abs(point.x()) >= 0.002)
        add(point, bone_sd, -1);  // of two so near the midplane one would be dropped
  system_ = BoneSystem(observations_, {}, smoothing, 1);
}

splines::Warp HeadWarp::operator()(const std::vector<LandmarkPair>& pairs, const BoneMap& map) const {
  std::vector<Observation> placed = observations_;
  std::vector<Vec3> bone;
  for (const Observation& observation : placed)
    bone.push_back(observation.from);
  bone = map(std::span<const Vec3>(bone));
  for (size_t i = 0; i < placed.size(); ++i)
    placed[i].to = skin_pairs_[i] < 0 ? bone[i] : pairs[static_cast<size_t>(skin_pairs_[i])].target.skin;
  return system_.warp(system_.displacements(placed, {}));
}

}  // namespace fascia::skull
