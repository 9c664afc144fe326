#pragma once

#include "builder/tissue/region.h"

namespace fascia::tissue {

/// A place on the free edge of lip or lid, where outer skin turns into lining, on the input's own mesh.
struct MarginPlace {
  Vec3 position;
  int vertex;  ///< of the region, nearest
};

/// The edge around `opening`, sampled along the region's edges: the same for every level of detail.
std::vector<MarginPlace> margin_places(const FaceRegion& region, Opening opening);

/// What is known along an edge, read as a smooth function of the place across the opening, 0 at its right
/// corner to 1 at its left.
class Margin {
 public:
  void add(double place, const Eigen::Vector2d& value) { samples_.emplace_back(place, value); }
  bool empty() const { return samples_.empty(); }
  /// Mean of the samples near `place`, of the nearest ones where there are none near; zero without any.
  Eigen::Vector2d at(double place) const;

 private:
  std::vector<std::pair<double, Eigen::Vector2d>> samples_;
};

}  // namespace fascia::tissue
