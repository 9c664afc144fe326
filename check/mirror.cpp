#include "check/mirror.h"

#include <algorithm>

namespace fascia::check {
namespace {

/// The landmarks of both sides and evenly chosen vertices about them.
std::vector<Vec3> places_of(const TriangleMesh& skin, const std::map<std::string, Vec3>& landmarks) {
  std::vector<Vec3> places;
  for (const auto& [name, p] : landmarks)
    if (name.ends_with("_left") || name.ends_with("_right")) places.push_back(p);
  const Bounds face = bounds(places);
  const std::vector<Vec3> normals = vertex_normals(skin);
  std::vector<Vec3> front;
  for (size_t v = 0; v < normals.size(); ++v)
    if (normals[v].z() > 0.2 && skin.vertices[v].z() > face.centre().z()) front.push_back(skin.vertices[v]);
  constexpr size_t count = 240;
  for (size_t i = 0; i < count && front.size() >= count; ++i)
    places.push_back(front[i * front.size() / count]);
  return places;
}

/// The plane between the landmarks of both sides.
spatial::MirrorPlane between(const std::map<std::string, Vec3>& landmarks) {
  std::vector<std::pair<Vec3, Vec3>> pairs;
  for (const auto& [name, p] : landmarks) {
    if (!name.ends_with("_left")) continue;
    const auto other = landmarks.find(name.substr(0, name.size() - 5) + "_right");
    if (other != landmarks.end()) pairs.emplace_back(p, other->second);
  }
  return spatial::plane_between(pairs).value_or(spatial::MirrorPlane{});
}

}  // namespace

MirrorPoints::MirrorPoints(const Skin& skin, const std::map<std::string, Vec3>& landmarks, double size)
    : skin_(skin) {
  const spatial::SurfaceQuery query(skin.rest());
  const std::vector<Vec3> places = places_of(skin.rest(), landmarks);
  plane_ = spatial::fit_mirror_plane(query, places, between(landmarks), 0.008 * size).plane;
  for (const Vec3& p : places) {
    const spatial::ClosestPoint here = query.nearest_place(p, 0.01 * size);
    if (!here.found()) continue;
    const spatial::ClosestPoint there = query.nearest_place(plane_.image(here.position), 0.0025 * size);
    if (!there.found()) continue;
    const Vec3 facing = plane_.turned(triangle_normal(skin.rest(), here.surface.triangle));
    if (facing.dot(triangle_normal(skin.rest(), there.surface.triangle)) < 0.3) continue;
    pairs_.push_back({here.surface, there.surface});
  }
}

double MirrorPoints::asymmetry(const std::vector<Vec3>& skin, Vec3& worst_place) const {
  const auto moved = [&](const SurfacePoint& point) {
    return Vec3(place(skin_.rest(), skin, point) - position(skin_.rest(), point));
  };
  std::vector<std::pair<double, size_t>> off;
  for (size_t k = 0; k < pairs_.size(); ++k)
    off.emplace_back((moved(pairs_[k].here) - plane_.turned(moved(pairs_[k].there))).norm(), k);
  if (off.empty()) return 0.0;
  const auto at = off.begin() + static_cast<std::ptrdiff_t>(0.95 * static_cast<double>(off.size() - 1));
  std::nth_element(off.begin(), at, off.end());
  worst_place = place(skin_.rest(), skin, pairs_[at->second].here);
  return at->first;
}

}  // namespace fascia::check
