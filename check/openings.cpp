#include "check/openings.h"

#include <algorithm>

namespace fascia::check {

MouthOpening mouth_opening(const Skin& skin, const Seam& seam, const std::vector<Vec3>& vertices,
                           double parted) {
  MouthOpening out;
  if (seam.empty()) return out;
  std::vector<double> gaps;
  for (size_t s = 0; s < seam.stations.size(); ++s) {
    const Vec3 apart =
        place(skin.rest(), vertices, seam.upper_edge[s]) - place(skin.rest(), vertices, seam.lower_edge[s]);
    gaps.push_back(apart.y() > 0.0 ? apart.norm() : 0.0);  // lips that have passed each other are not open
  }
  out.most = *std::max_element(gaps.begin(), gaps.end());
  out.parted_share =
      static_cast<double>(std::count_if(gaps.begin(), gaps.end(), [&](double g) { return g > parted; })) /
      static_cast<double>(gaps.size());
  if (out.most <= parted) return out;
  // Where the opening ends is seen from the gaps, for the cheilia may have been placed a little beside the
  // corners.
  const auto gap = [&](double station) {
    const auto after = std::upper_bound(seam.stations.begin(), seam.stations.end(), station);
    if (after == seam.stations.begin()) return gaps.front();
    if (after == seam.stations.end()) return gaps.back();
    const auto k = static_cast<size_t>(after - seam.stations.begin());
    const double t = (station - seam.stations[k - 1]) / (seam.stations[k] - seam.stations[k - 1]);
    return (1.0 - t) * gaps[k - 1] + t * gaps[k];
  };
  size_t first = 0, last = gaps.size() - 1;
  while (gaps[first] <= parted)
    ++first;
  while (gaps[last] <= parted)
    --last;
  const double step = 1.0 / (static_cast<double>(gaps.size()) + 1.0);
  const double from = seam.stations[first] - step, to = seam.stations[last] + step;
  constexpr double corner = 0.15;  // of the width
  out.corner_right = gap(from + corner * (to - from)) / out.most;
  out.corner_left = gap(to - corner * (to - from)) / out.most;
  return out;
}

}  // namespace fascia::check
