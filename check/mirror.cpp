#include "check/mirror.h"

#include <algorithm>
#include <array>
#include <optional>

#include "check/seam.h"

namespace fascia::check {
namespace {

/// The landmarks of both sides and evenly chosen vertices about them.
std::vector<Vec3> places_of(const TriangleMesh& skin, const Landmarks& landmarks) {
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
spatial::MirrorPlane between(const Landmarks& landmarks) {
  std::vector<std::pair<Vec3, Vec3>> pairs;
  for (const auto& [name, p] : landmarks) {
    if (!name.ends_with("_left")) continue;
    const auto other = landmarks.find(name.substr(0, name.size() - 5) + "_right");
    if (other != landmarks.end()) pairs.emplace_back(p, other->second);
  }
  return spatial::plane_between(pairs).value_or(spatial::MirrorPlane{});
}

/// The skin, and what of it is of either side of an opening.
class SidedSkin {
 public:
  SidedSkin(const TriangleMesh& skin, const std::vector<uint8_t>& sides) : query_(skin) {
    if (sides.empty()) return;
    side_.resize(skin.triangles.size(), Seam::none);
    std::vector<fascia::Triangle> triangles[3];
    for (int t = 0; t < skin.triangle_count(); ++t) {
      const fascia::Triangle& corners = skin.triangles[static_cast<size_t>(t)];
      const auto side = [&](size_t k) { return sides[static_cast<size_t>(corners[k])]; };
      if (side(0) == Seam::none || side(1) != side(0) || side(2) != side(0)) continue;
      side_[static_cast<size_t>(t)] = side(0);
      triangles[side(0)].push_back(corners);
      own_[side(0)].push_back(t);
    }
    for (const Seam::Side side : {Seam::upper, Seam::lower})
      if (!triangles[side].empty()) of_side_[side].emplace(TriangleMesh{skin.vertices, triangles[side]});
  }

  const spatial::SurfaceQuery& all() const { return query_; }

  /// The place nearest to the image `p` of `here` within `reach`, of the same side if `here` is of one.
  std::optional<SurfacePoint> image(const SurfacePoint& here, const Vec3& p, double reach) const {
    const spatial::ClosestPoint any = query_.nearest_place(p, reach);
    if (!any.found()) return {};
    const uint8_t side = side_of(here), other = side_of(any.surface);
    if (side == Seam::none || other == Seam::none || side == other) return any.surface;
    if (!of_side_[side]) return {};
    const spatial::ClosestPoint own = of_side_[side]->nearest_place(p, reach);
    if (!own.found()) return {};
    return SurfacePoint{own_[side][static_cast<size_t>(own.surface.triangle)], own.surface.barycentric};
  }

 private:
  uint8_t side_of(const SurfacePoint& point) const {
    return side_.empty() ? static_cast<uint8_t>(Seam::none) : side_[static_cast<size_t>(point.triangle)];
  }

  spatial::SurfaceQuery query_;
  std::vector<uint8_t> side_;  // of the triangles
  std::array<std::optional<spatial::SurfaceQuery>, 3> of_side_;
  std::array<std::vector<int>, 3> own_;  // triangles of the skin, by side
};

}  // namespace

MirrorPoints::MirrorPoints(const Skin& skin, const Landmarks& landmarks, double size,
                           const std::vector<uint8_t>& sides)
    : skin_(skin) {
  const SidedSkin sided(skin.rest(), sides);
  const std::vector<Vec3> places = places_of(skin.rest(), landmarks);
  plane_ = spatial::fit_mirror_plane(sided.all(), places, between(landmarks), 0.008 * size).plane;
  for (const Vec3& p : places) {
    const spatial::ClosestPoint here = sided.all().nearest_place(p, 0.01 * size);
    if (!here.found()) continue;
    const auto there = sided.image(here.surface, plane_.image(here.position), 0.0025 * size);
    if (!there) continue;
    const Vec3 facing = plane_.turned(triangle_normal(skin.rest(), here.surface.triangle));
    if (facing.dot(triangle_normal(skin.rest(), there->triangle)) < 0.3) continue;
    pairs_.push_back({here.surface, *there});
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
