#include "builder/tissue/mirror.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <optional>
#include <string>

#include "builder/spatial/surface_query.h"
#include "geometry/connectivity.h"

namespace fascia::tissue {
namespace {

constexpr double on_plane = 5e-5;  // metres

/// A corner of a triangle being cut.
struct Corner {
  int vertex;        // of the half
  double distance;   // from the plane
  Vec3 barycentric;  // in the triangle that is cut
};

/// Of each vertex on the border of `mesh` its neighbours along it.
std::vector<std::pair<int, int>> border_neighbours(const TriangleMesh& mesh) {
  std::vector<std::pair<int, int>> beside(mesh.vertices.size(), {-1, -1});
  for (const auto& loop : boundary_loops(mesh, connectivity(mesh)))
    for (size_t k = 0; k < loop.size(); ++k)
      beside[static_cast<size_t>(loop[k])] = {loop[(k + loop.size() - 1) % loop.size()],
                                              loop[(k + 1) % loop.size()]};
  return beside;
}

/// Which vertices lie on the plane: those of the border that are near it, and those that such ones enclose.
std::vector<bool> along_cut(const TriangleMesh& mesh, const Symmetry& plane) {
  constexpr double near = 2e-4, farthest = 1.5e-3;  // metres
  const auto beside = border_neighbours(mesh);
  std::vector<bool> cut(mesh.vertices.size());
  for (size_t v = 0; v < cut.size(); ++v)
    cut[v] = beside[v].first >= 0 && std::abs(plane.distance(mesh.vertices[v])) < near;
  for (bool any = true; any;) {
    any = false;
    for (size_t v = 0; v < cut.size(); ++v)
      if (!cut[v] && beside[v].first >= 0 && cut[static_cast<size_t>(beside[v].first)] &&
          cut[static_cast<size_t>(beside[v].second)] && std::abs(plane.distance(mesh.vertices[v])) < farthest)
        any = cut[v] = true;
  }
  return cut;
}

rig::Vec3f image_of(const Symmetry& plane, const rig::Vec3f& p) {
  return plane.image(p.cast<double>()).cast<float>();
}

std::string left_name(const std::string& name) {
  constexpr size_t side = 6;  // _right
  return name.ends_with("_right") ? name.substr(0, name.size() - side) + "_left" : std::string();
}

template <class Part>
const Part* find_named(const std::vector<Part>& parts, const std::string& name) {
  const auto at = std::find_if(parts.begin(), parts.end(), [&](const Part& p) { return p.name == name; });
  return name.empty() || at == parts.end() ? nullptr : &*at;
}

/// Finds the places on a skin that images of places stand for.
class ImageFinder {
 public:
  /// `lower_lip`: see Beneath, or empty.
  ImageFinder(const TriangleMesh& mesh, const std::vector<double>& lower_lip)
      : mesh_(mesh), query_(mesh), lower_lip_(lower_lip) {
    if (lower_lip_.empty()) return;
    std::vector<fascia::Triangle> lips[2];
    for (int t = 0; t < mesh.triangle_count(); ++t) {
      const size_t lip = lip_of({t, Vec3::Constant(1.0 / 3.0)}) > 0.5;
      lips[lip].push_back(mesh.triangles[static_cast<size_t>(t)]);
      triangle_of_[lip].push_back(t);
    }
    for (const size_t lip : {0, 1})
      if (!lips[lip].empty()) lip_queries_[lip].emplace(TriangleMesh{mesh.vertices, lips[lip]});
  }

  /// How far a place belongs to the lower lip: 0 to 1.
  double lip_of(const SurfacePoint& place) const {
    if (lower_lip_.empty()) return 0.0;
    const fascia::Triangle& corners = mesh_.triangles[static_cast<size_t>(place.triangle)];
    double lip = 0.0;
    for (size_t k = 0; k < 3; ++k)
      lip += place.barycentric[static_cast<int>(k)] * lower_lip_[static_cast<size_t>(corners[k])];
    return lip;
  }

  /// The place nearest to `p`, within `off`. Of a thin fold, as a lid's edge is, the side that faces as
  /// `facing` does; of lips that touch, the one of `lip`.
  std::optional<SurfacePoint> place(const Vec3& p, const Vec3& facing, double lip, double off) const {
    constexpr double same_lip = 0.3;
    const auto found = nearest(p, facing, off);
    const size_t side = lip > 0.5;
    if (!found || std::abs(lip_of(*found) - lip) <= same_lip || !lip_queries_[side]) return found;
    const spatial::ClosestPoint own = lip_queries_[side]->nearest_place(p, off);
    if (!own.found()) return found;
    return SurfacePoint{triangle_of_[side][static_cast<size_t>(own.surface.triangle)],
                        own.surface.barycentric};
  }

 private:
  std::optional<SurfacePoint> nearest(const Vec3& p, const Vec3& facing, double off) const {
    constexpr double least_facing = 0.2;
    const auto faces = [&](const SurfacePoint& at) {
      return facing.dot(triangle_normal(mesh_, at.triangle)) > least_facing;
    };
    const spatial::ClosestPoint nearest = query_.nearest_place(p, off);
    if (!nearest.found()) return {};
    if (faces(nearest.surface)) return nearest.surface;
    std::optional<spatial::RayHit> best;
    for (const Vec3& way : {facing, Vec3(-facing)})
      for (const spatial::RayHit& hit : query_.all_hits(p, way, off))
        if (faces(hit.surface) && (!best || hit.distance < best->distance)) best = hit;
    return best ? best->surface : nearest.surface;
  }

  const TriangleMesh& mesh_;
  spatial::SurfaceQuery query_;
  const std::vector<double>& lower_lip_;
  std::array<std::optional<spatial::SurfaceQuery>, 2> lip_queries_;  // of the upper lip, of the lower
  std::array<std::vector<int>, 2> triangle_of_;                      // of their triangles, in the mesh
};

}  // namespace

std::optional<Symmetry> symmetry_of(const TissueInputs& inputs, const FaceRegion& region) {
  constexpr double within = 10.0, alike = 1.5, exact = 0.35;  // millimetres of an adult's face
  std::vector<std::pair<Vec3, Vec3>> pairs;
  for (const auto& [name, right] : inputs.landmarks)
    if (const auto left = inputs.landmarks.find(left_name(name)); left != inputs.landmarks.end())
      pairs.emplace_back(left->second, right);
  const auto plane = spatial::plane_between(pairs);
  if (pairs.size() < 3 || !plane) return {};
  const double unit =
      spatial::adult_millimetre(landmark(inputs, "exocanthion_left"), landmark(inputs, "exocanthion_right"),
                                inputs.mechanics.smas_shape.adult_width);
  const Vec3 chin = landmark(inputs, "gnathion"), brow = landmark(inputs, "glabella");
  std::vector<Vec3> places;  // of the face between chin and brow, where neither neck nor hair begin
  for (size_t v = 0; v < region.mesh.vertices.size(); ++v)
    if (const Vec3& p = region.mesh.vertices[v];
        region.outer[v] && p.y() > chin.y() && p.y() < brow.y() + 15.0 * unit)
      places.push_back(p);
  constexpr size_t most_places = 600;
  const size_t step = places.size() / most_places + 1;
  std::vector<Vec3> tried;
  for (size_t i = 0; i < places.size(); i += step)
    tried.push_back(places[i]);
  const spatial::MirrorFit fit =
      spatial::fit_mirror_plane(spatial::SurfaceQuery(region.mesh), tried, *plane, within * unit);
  if (!fit.covers(tried.size())) return {};
  const double most = fit.most_apart();
  if (most > alike * unit) return {};
  Symmetry symmetry{fit.plane};
  symmetry.is_exact = most < exact * unit;
  return symmetry;
}

HalfRegion left_half(const TriangleMesh& mesh, const Symmetry& plane) {
  HalfRegion half;
  std::vector<double> distance(mesh.vertices.size());
  for (size_t v = 0; v < distance.size(); ++v) {
    distance[v] = plane.distance(mesh.vertices[v]);
    if (std::abs(distance[v]) < on_plane) distance[v] = 0.0;
  }
  std::vector<int> kept(mesh.vertices.size(), -1);
  std::map<std::pair<int, int>, int> cuts;
  const auto add = [&](const Vec3& p, int triangle, const Vec3& barycentric) {
    half.mesh.vertices.push_back(p);
    half.source.push_back({triangle, barycentric});
    return half.mesh.vertex_count() - 1;
  };
  for (int t = 0; t < mesh.triangle_count(); ++t) {
    const fascia::Triangle& triangle = mesh.triangles[static_cast<size_t>(t)];
    const auto d = [&](size_t k) { return distance[static_cast<size_t>(triangle[k % 3])]; };
    if (std::max({d(0), d(1), d(2)}) <= 0.0) continue;
    std::vector<Corner> polygon;
    for (size_t k = 0; k < 3; ++k) {
      const int a = triangle[k], b = triangle[(k + 1) % 3];
      Vec3 at_a = Vec3::Zero(), at_b = Vec3::Zero();
      at_a[static_cast<int>(k)] = 1.0;
      at_b[static_cast<int>((k + 1) % 3)] = 1.0;
      if (d(k) >= 0.0) {
        int& index = kept[static_cast<size_t>(a)];
        const Vec3& p = mesh.vertices[static_cast<size_t>(a)];
        if (index < 0) index = add(d(k) == 0.0 ? plane.foot(p) : p, t, at_a);
        polygon.push_back({index, d(k), at_a});
      }
      if (d(k) * d(k + 1) >= 0.0) continue;
      const double share = d(k) / (d(k) - d(k + 1));
      const Vec3 between = (1.0 - share) * at_a + share * at_b;
      const auto [at, is_new] = cuts.try_emplace({std::min(a, b), std::max(a, b)}, -1);
      if (is_new)
        at->second = add(plane.foot((1.0 - share) * mesh.vertices[static_cast<size_t>(a)] +
                                    share * mesh.vertices[static_cast<size_t>(b)]),
                         t, between);
      polygon.push_back({at->second, 0.0, between});
    }
    for (size_t k = 1; k + 1 < polygon.size(); ++k) {
      half.mesh.triangles.push_back({polygon[0].vertex, polygon[k].vertex, polygon[k + 1].vertex});
      half.parent.push_back(t);
      half.corners.push_back({polygon[0].barycentric, polygon[k].barycentric, polygon[k + 1].barycentric});
    }
  }
  return half;
}

RemeshResult on_region(const RemeshResult& given, const HalfRegion& region, const Symmetry& plane) {
  RemeshResult half = given;
  for (SurfacePoint& place : half.source) {
    const auto t = static_cast<size_t>(place.triangle);
    Vec3 barycentric = Vec3::Zero();
    for (size_t k = 0; k < 3; ++k)
      barycentric += place.barycentric[static_cast<int>(k)] * region.corners[t][k];
    place = {region.parent[t], barycentric};
  }
  const std::vector<bool> cut = along_cut(half.mesh, plane);
  for (size_t v = 0; v < cut.size(); ++v)
    if (cut[v]) half.mesh.vertices[v] = plane.foot(half.mesh.vertices[v]);
  // A triangle in the plane would lie on its own image.
  std::vector<bool> keep;
  for (const fascia::Triangle& t : half.mesh.triangles)
    keep.push_back(!std::all_of(t.begin(), t.end(), [&](int v) { return cut[static_cast<size_t>(v)]; }));
  std::vector<int> map;
  RemeshResult result{submesh(half.mesh, keep, &map), {}};
  result.source.resize(result.mesh.vertices.size());
  for (size_t v = 0; v < map.size(); ++v)
    if (map[v] >= 0) result.source[static_cast<size_t>(map[v])] = half.source[v];
  return result;
}

std::optional<RemeshResult> with_images(const RemeshResult& half, const FaceRegion& region,
                                        const std::vector<double>& lower_lip, const Symmetry& plane,
                                        std::vector<size_t>& left) {
  const double off = plane.is_exact ? 1.5e-3 : 8e-3;  // metres: farther from the skin is no image
  constexpr double ends = 0.025;                      // metres
  const ImageFinder finder(region.mesh, lower_lip);
  const auto beside = border_neighbours(half.mesh);
  size_t missing = 0;
  const size_t n = half.mesh.vertices.size(), triangles = half.mesh.triangles.size();
  RemeshResult full = half;
  std::vector<int> image(n);
  left.clear();
  for (size_t v = 0; v < n; ++v) {
    image[v] = static_cast<int>(v);
    if (std::abs(plane.distance(half.mesh.vertices[v])) < 1e-9) continue;
    image[v] = static_cast<int>(full.mesh.vertices.size());
    left.push_back(v);
    const Vec3 p = plane.image(half.mesh.vertices[v]);
    const Vec3 facing = plane.turned(triangle_normal(region.mesh, half.source[v].triangle));
    const double lip = finder.lip_of(half.source[v]);
    auto place = finder.place(p, facing, lip, off);
    if (!place) {
      // Where the region ends its last triangles may reach farther on one side.
      place = finder.place(p, facing, lip, ends);
      missing += !place || beside[v].first < 0;
      if (!place) place = finder.place(p, facing, lip, std::numeric_limits<double>::infinity());
      if (!place) return {};
    }
    full.source.push_back(*place);
    full.mesh.vertices.push_back(plane.is_exact ? p : position(region.mesh, *place));
  }
  size_t turned = 0;
  for (size_t t = 0; t < triangles; ++t) {
    const fascia::Triangle k = half.mesh.triangles[t];
    full.mesh.triangles.push_back({image[static_cast<size_t>(k[0])], image[static_cast<size_t>(k[2])],
                                   image[static_cast<size_t>(k[1])]});
    const Vec3 facing = plane.turned(triangle_normal(half.mesh, static_cast<int>(t)));
    const auto own = static_cast<int>(triangles + t);
    turned += facing.dot(triangle_normal(full.mesh, own)) < 0.3 ||
              triangle_area(full.mesh, own) < 0.2 * triangle_area(half.mesh, static_cast<int>(t));
  }
  if (missing > n / 100 || turned > triangles / 50) return {};
  return full;
}

TissueInputs with_mirrored_sides(TissueInputs inputs, const Symmetry& plane) {
  for (rig::Muscle& muscle : inputs.muscles) {
    if (inputs.has_muscles_by_hand) break;
    if (const rig::Muscle* left = find_named(inputs.muscles, left_name(muscle.name));
        left && left->fibre_offsets.size() > 1 && muscle.fibre_offsets.size() > 1) {
      muscle.fibre_offsets = left->fibre_offsets;
      muscle.points.clear();
      for (const rig::Vec3f& p : left->points)
        muscle.points.push_back(image_of(plane, p));
      muscle.strength = left->strength;
      muscle.peak_shortening = left->peak_shortening;
    }
  }
  for (rig::Ligament& ligament : inputs.ligaments)
    if (const rig::Ligament* left = find_named(inputs.ligaments, left_name(ligament.name))) {
      ligament.bone = image_of(plane, left->bone);
      ligament.skin = image_of(plane, left->skin);
      ligament.stiffness = left->stiffness;
    }
  return inputs;
}

}  // namespace fascia::tissue
