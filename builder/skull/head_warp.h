#pragma once

#include <vector>

#include "builder/skull/bone_system.h"
#include "builder/skull/landmark_pairs.h"
#include "builder/skull/skull.h"

namespace fascia::skull {

/// One map for skin and bone: through skin landmarks and points spread over the bones, where both arrived.
/// Factored once; landmarks may move.
class HeadWarp {
 public:
  HeadWarp() = default;
  HeadWarp(const Generic& generic, const std::vector<LandmarkPair>& pairs);
  splines::Warp operator()(const std::vector<LandmarkPair>& pairs, const BoneMap& map) const;

 private:
  std::vector<Observation> observations_;
  std::vector<int> skin_pairs_;  // pair of each observation, -1: a bone point
  BoneSystem system_;
};

}  // namespace fascia::skull
