#include "check/landmark_motion.h"

#include <algorithm>

#include "builder/spatial/surface_query.h"

namespace fascia::check {

TrackedLandmarks::TrackedLandmarks(const Skin& skin, const Landmarks& landmarks) : skin_(skin) {
  if (skin.rest().triangles.empty()) return;
  const spatial::SurfaceQuery query(skin.rest());
  for (const auto& [name, p] : landmarks) {
    const spatial::ClosestPoint hit = query.nearest_place(p, 0.01);
    if (hit.found()) places_[name] = hit.surface;
  }
}

Vec3 TrackedLandmarks::at(const std::string& name, const std::vector<Vec3>& skin) const {
  const auto found = places_.find(name);
  return found == places_.end() ? Vec3::Zero() : place(skin_.rest(), skin, found->second);
}

Vec3 TrackedLandmarks::moved(const std::string& name, const std::vector<Vec3>& skin) const {
  if (!has(name)) return Vec3::Zero();
  return at(name, skin) - position(skin_.rest(), places_.at(name));
}

double along(const Vec3& motion, const std::string& direction, bool left) {
  const double out = left ? motion.x() : -motion.x();
  if (direction == "up") return motion.y();
  if (direction == "down") return -motion.y();
  if (direction == "out") return out;
  if (direction == "in") return -out;
  if (direction == "forward") return motion.z();
  if (direction == "back") return -motion.z();
  return motion.norm();
}

}  // namespace fascia::check
