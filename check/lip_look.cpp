#include "check/lip_look.h"

#include <cmath>
#include <optional>

#include "builder/spatial/surface_query.h"

namespace fascia::check {
namespace {

constexpr double views[] = {0.0, 0.61, -0.61};  // radians to the subject's left

Vec3 toward(double view) {
  return Vec3(std::sin(view), 0.0, std::cos(view));
}

std::vector<bool> outer_triangles(const TriangleMesh& lips) {
  const spatial::SurfaceQuery query(lips);
  const std::vector<Vec3> normals = vertex_normals(lips);
  std::vector<bool> is_seen(lips.vertices.size(), false);
  constexpr double off = 1e-5;  // metres: clear of the vertex' own triangles
  for (size_t v = 0; v < is_seen.size(); ++v)
    for (const double view : views)
      if (normals[v].dot(toward(view)) > 0.1 &&
          !query.blocked(lips.vertices[v] + off * normals[v], toward(view)))
        is_seen[v] = true;
  std::vector<bool> is_outer;
  for (const Triangle& t : lips.triangles)
    is_outer.push_back(is_seen[static_cast<size_t>(t[0])] && is_seen[static_cast<size_t>(t[1])] &&
                       is_seen[static_cast<size_t>(t[2])]);
  return is_outer;
}

}  // namespace

LipLook::LipLook(const Head& head, const Skin& skin, const TrackedLandmarks& landmarks, double size)
    : head_(head), landmarks_(landmarks), size_(size) {
  const std::vector<Vec3>& rest = skin.rest().vertices;
  const Vec3 left = landmarks.at("cheilion_left", rest), right = landmarks.at("cheilion_right", rest);
  lips_ = patch_about(skin.rest(), 0.5 * (left + right), 0.9 * (left - right).norm());
  is_outer_ = outer_triangles(lips_.mesh(rest));
  for (size_t p = 0; p < head.parts.size(); ++p) {
    const std::string& name = head.parts[p].name;
    if (name.rfind("teeth", 0) == 0 || name.rfind("gums", 0) == 0 || name == "mouth_interior")
      teeth_.push_back(p);
  }
}

Poking LipLook::look(const std::vector<Vec3>& skin, const Shape& shape) const {
  Poking out;
  if (lips_.triangles.empty()) return out;
  const spatial::SurfaceQuery lips(lips_.mesh(skin));
  std::optional<spatial::SurfaceQuery> teeth;
  TriangleMesh all;
  for (const size_t part : teeth_) {
    const int first = all.vertex_count();
    all.vertices.insert(all.vertices.end(), shape[part].begin(), shape[part].end());
    for (const Triangle& t : head_.parts[part].mesh.triangles)
      all.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  if (!all.triangles.empty()) teeth.emplace(std::move(all));
  const Vec3 left = landmarks_.at("cheilion_left", skin), right = landmarks_.at("cheilion_right", skin),
             top = landmarks_.at("labiale_superius", skin), bottom = landmarks_.at("labiale_inferius", skin);
  const double step = 0.001 * size_, margin = 0.008 * size_, deepest = 0.005 * size_;
  const double high = std::max({top.y(), left.y(), right.y()}) + margin,
               low = std::min({bottom.y(), left.y(), right.y()}) - margin;
  const Vec3 middle = 0.5 * (left + right);
  const double half = 0.5 * (left - right).norm() + margin;
  for (const double view : views) {
    const Vec3 ray = -toward(view), across(std::cos(view), 0.0, -std::sin(view));
    for (double y = high; y > low; y -= step)
      for (double x = -half; x < half; x += step) {
        Vec3 origin = middle + x * across - 0.1 * ray;
        origin.y() = y;
        const auto hit = lips.first_hit(origin, ray, 0.2);
        if (!hit) continue;
        if (hit->from_outside) {
          if (!teeth || !is_outer_[static_cast<size_t>(hit->surface.triangle)]) continue;
          const auto tooth = teeth->first_hit(origin, ray, hit->distance, hit->distance - deepest);
          if (tooth) out.teeth.take({hit->distance - tooth->distance, tooth->position});
          continue;
        }
        const auto behind = lips.first_hit(origin, ray, hit->distance + deepest, hit->distance + 1e-5);
        if (behind && behind->from_outside && is_outer_[static_cast<size_t>(behind->surface.triangle)])
          out.lining.take({behind->distance - hit->distance, hit->position});
      }
  }
  return out;
}

}  // namespace fascia::check
