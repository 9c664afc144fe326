#include "builder/landmarks/nose_profile.h"

#include <vector>

namespace fascia::landmarks {

namespace {

constexpr int steps = 160;
// Metres of the generic head.
constexpr double before = 0.12, behind = 0.1;  // rays begin and end so far off the midline's chord
constexpr double least_rise = 0.004;           // of the nose over the sellion
constexpr double least_fall = 0.0025;          // from the tip to the lip: less is a dent
constexpr double least_hollow = 0.001;         // from the base to the lip
constexpr double longest_base = 0.025;         // from the tip down to the base

/// The skin as seen from the front, from above.
struct Profile {
  std::vector<Vec3> places;
  std::vector<double> fronts;
};

Profile profile_of(const spatial::SurfaceQuery& skin, const Midline& midline) {
  Profile profile;
  for (int k = 0; k <= steps; ++k) {
    const Vec3 on = midline.sellion + k / static_cast<double>(steps) * (midline.menton - midline.sellion);
    const auto hit = skin.first_hit(on + before * midline.scale * midline.forward, -midline.forward,
                                    (before + behind) * midline.scale);
    if (!hit || !hit->from_outside) continue;
    profile.places.push_back(hit->position);
    profile.fronts.push_back(hit->position.dot(midline.forward));
  }
  return profile;
}

}  // namespace

std::optional<NoseProfile> nose_profile(const spatial::SurfaceQuery& skin, const Midline& midline) {
  const Profile profile = profile_of(skin, midline);
  const std::vector<double>& front = profile.fronts;
  if (front.empty()) return {};
  // The tip: the farthest forward before the skin has fallen back.
  size_t tip = 0, k = 0;
  for (; k < front.size(); ++k) {
    if (front[k] > front[tip]) tip = k;
    const bool has_risen = front[tip] - front[0] > least_rise * midline.scale;
    if (has_risen && front[tip] - front[k] > least_fall * midline.scale) break;
  }
  if (k == front.size()) return {};
  NoseProfile nose{profile.places[tip], {}};
  // The base: the deepest place before the skin comes forward again.
  size_t base = k;
  for (; k < front.size(); ++k) {
    if ((profile.places[k] - nose.tip).norm() > longest_base * midline.scale) break;
    if (front[k] < front[base]) base = k;
    if (front[k] - front[base] < least_hollow * midline.scale) continue;
    nose.base = profile.places[base];
    break;
  }
  return nose;
}

}  // namespace fascia::landmarks
