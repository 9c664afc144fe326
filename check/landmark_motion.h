#pragma once

#include <map>
#include <string>
#include <vector>

#include "check/skin.h"
#include "geometry/landmarks.h"

namespace fascia::check {

/// The landmarks as places on the skin that go with it.
class TrackedLandmarks {
 public:
  TrackedLandmarks(const Skin& skin, const Landmarks& landmarks);

  /// How far the landmark has moved, metres; zero when the head has none of that name.
  Vec3 moved(const std::string& name, const std::vector<Vec3>& skin) const;
  /// Where it stands.
  Vec3 at(const std::string& name, const std::vector<Vec3>& skin) const;
  bool has(const std::string& name) const { return places_.count(name) > 0; }

 private:
  const Skin& skin_;
  std::map<std::string, SurfacePoint> places_;
};

/// Part of `motion` that goes `direction`: up, down, out (from the midplane), in, forward, back, or away (its
/// length); metres. `left`: which side `out` is to.
double along(const Vec3& motion, const std::string& direction, bool left);

}  // namespace fascia::check
