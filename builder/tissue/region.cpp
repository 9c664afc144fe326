#include "builder/tissue/region.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "builder/spatial/surface_query.h"
#include "builder/tissue/distance.h"
#include "builder/tissue/empty_eyes.h"
#include "geometry/connectivity.h"
#include "geometry/error.h"
#include "geometry/smoothstep.h"

namespace fascia::tissue {
namespace {

/// How far inside the region's limits a point lies, metres; negative outside.
double margin_at(const TissueInputs& inputs, const Vec3& p) {
  const Vec3 ear = 0.5 * (landmark(inputs, "tragion_left") + landmark(inputs, "tragion_right"));
  const Vec3 glabella = landmark(inputs, "glabella"), chin = landmark(inputs, "gnathion");
  const anatomy::mechanics::Region& m = inputs.mechanics.region;
  const double third = face_third(inputs);
  const auto hairline = inputs.landmarks.find("trichion");
  const double top = (hairline != inputs.landmarks.end() ? hairline->second.y() : glabella.y() + third) +
                     m.above_hairline * third;
  const double bottom = chin.y() - m.below_chin * third;
  // In front of the ear; below the jaw's angle the neck turns away, so the limit goes back a little.
  const double below = std::clamp((ear.y() - m.jaw_angle * third - p.y()) / third, 0.0, 1.0);
  const double back = ear.z() + third * (m.before_ear - m.back_below_jaw * below);
  return std::min({top - p.y(), p.y() - bottom, p.z() - back});
}

/// Whether a skin vertex is seen from outside: some ray in the half space before the face escapes.
std::vector<bool> seen_from_outside(const TissueInputs& inputs, const std::vector<double>& margin) {
  TriangleMesh blocking = inputs.skin;
  for (const PartMesh& part : inputs.parts) {
    if (part.part == "skin" || part.part == "lashes" || part.part == "brows" || part.part == "hair" ||
        part.part == "other")
      continue;
    const int first = blocking.vertex_count();
    blocking.vertices.insert(blocking.vertices.end(), part.vertices.begin(), part.vertices.end());
    for (const fascia::Triangle& t : part.triangles)
      blocking.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  }
  hang_curtains(inputs, blocking);
  constexpr double beyond = 0.01;  // metres past the region's limits that are looked at
  constexpr double socket = 1.01;  // radii of the globe: nearer is inside the orbit
  const spatial::SurfaceQuery query(blocking);
  const std::vector<Vec3> normals = vertex_normals(inputs.skin);
  const rig::Eye eyes[] = {eye_of(inputs, true), eye_of(inputs, false)};
  std::vector<bool> seen(inputs.skin.vertices.size(), false);
  for (size_t v = 0; v < seen.size(); ++v) {
    if (margin[v] < -beyond) continue;
    const Vec3& p = inputs.skin.vertices[v];
    bool in_socket = false;  // seen through an open fissure of a head without eyeballs, yet inside
    for (const rig::Eye& eye : eyes)
      in_socket =
          in_socket || (p - eye.centre.cast<double>()).norm() < socket * static_cast<double>(eye.radius);
    if (in_socket) continue;
    const Vec3 start = p + 2e-4 * normals[v];
    for (int turn = -3; turn <= 3 && !seen[v]; ++turn)
      for (int tilt = -2; tilt <= 2 && !seen[v]; ++tilt) {
        const double a = turn * 0.4, b = tilt * 0.45;
        const Vec3 direction(std::sin(a) * std::cos(b), std::sin(b), std::cos(a) * std::cos(b));
        if (direction.dot(normals[v]) < 0.15) continue;
        seen[v] = !query.first_hit(start, direction, 0.3);
      }
  }
  return seen;
}

/// Removes specks: each vertex takes the value of most of its neighbours, in a few iterations.
void calm(const TriangleMesh& mesh, std::vector<bool>& flags) {
  const auto neighbours = vertex_neighbours(mesh);
  for (int pass = 0; pass < 2; ++pass) {
    std::vector<bool> next = flags;
    for (size_t v = 0; v < flags.size(); ++v) {
      int set = 0;
      for (const int n : neighbours[v])
        set += flags[static_cast<size_t>(n)] ? 1 : 0;
      const auto count = static_cast<int>(neighbours[v].size());
      if (4 * set > 3 * count) next[v] = true;
      if (4 * set < count) next[v] = false;
    }
    flags = next;
  }
}

/// The opening whose edge `p` lies at. The mouth is a line from corner to corner: nostrils may lie nearer to
/// its middle than the corners do.
Opening opening_at(const TissueInputs& inputs, const Vec3& p) {
  const Vec3 corner = landmark(inputs, "cheilion_right"), across = landmark(inputs, "cheilion_left") - corner;
  const Vec3 mouth = corner + std::clamp((p - corner).dot(across) / across.squaredNorm(), 0.0, 1.0) * across;
  const double half_width = 0.5 * across.norm();
  const rig::Eye left = eye_of(inputs, true), right = eye_of(inputs, false);
  const Vec3 nose = 0.5 * (landmark(inputs, "subnasale") + landmark(inputs, "pronasale"));
  constexpr double lids = 1.6;  // radii of the globe, as far as half the mouth's width in other scores
  constexpr double none = 2.5;  // half widths: farther off it is no opening of the face
  const double scores[] = {
      (p - mouth).norm() / half_width, (p - left.centre.cast<double>()).norm() / (lids * left.radius),
      (p - right.centre.cast<double>()).norm() / (lids * right.radius), (p - nose).norm() / half_width};
  const auto best = std::min_element(std::begin(scores), std::end(scores)) - std::begin(scores);
  return scores[best] < none ? static_cast<Opening>(best + 1) : Opening::none;
}

/// Stands for a distance where there is no way: finite, for it is interpolated and multiplied by zero.
constexpr double no_way = 1.0;  // metres

std::vector<double> finite_distances(const TriangleMesh& mesh, const std::vector<DistanceSeed>& seeds) {
  std::vector<double> distance = surface_distances(mesh, seeds).distance;
  for (double& d : distance)
    d = std::min(d, no_way);
  return distance;
}

/// The opening that a border loop of the region goes round, as where a mask has holes for mouth and eyes: the
/// loop lies about it with all its vertices. None when the loop is where the face ends.
Opening opening_of_loop(const TissueInputs& inputs, const TriangleMesh& mesh, const std::vector<int>& loop) {
  const Vec3 right = landmark(inputs, "cheilion_right"), left = landmark(inputs, "cheilion_left");
  std::array<int, 5> votes{};
  Vec3 centre = Vec3::Zero();
  for (const int v : loop) {
    const Vec3& p = mesh.vertices[static_cast<size_t>(v)];
    ++votes[static_cast<size_t>(opening_at(inputs, p))];
    centre += p / static_cast<double>(loop.size());
  }
  const auto most = std::max_element(votes.begin(), votes.end()) - votes.begin();
  if (10 * votes[static_cast<size_t>(most)] < 9 * static_cast<int>(loop.size())) return Opening::none;
  const auto opening = static_cast<Opening>(most);
  if (opening == Opening::mouth)
    return (centre - 0.5 * (left + right)).norm() < 0.5 * (left - right).norm() ? opening : Opening::none;
  if (opening == Opening::eye_left || opening == Opening::eye_right) {
    const std::string side = opening == Opening::eye_left ? "_left" : "_right";
    const Vec3 inner = landmark(inputs, "endocanthion" + side),
               outer = landmark(inputs, "exocanthion" + side);
    return (centre - 0.5 * (inner + outer)).norm() < 0.5 * (outer - inner).norm() ? opening : Opening::none;
  }
  return opening;
}

/// The outer vertices beyond which the skin goes on, or ends at the neck, behind the ears or on the forehead,
/// which the galea goes on from and holds. Where it ends within the face, as a mask does at the chin, nothing
/// holds it but the bone beneath.
std::vector<bool> rim_of(const TissueInputs& inputs, const TriangleMesh& skin, const FaceRegion& region,
                         const std::vector<bool>& eye) {
  const Vec3 glabella = landmark(inputs, "glabella"), gnathion = landmark(inputs, "gnathion");
  // The throat begins some way below the chin: a fifth of the face's height.
  const double neck = gnathion.y() - 0.2 * (glabella.y() - gnathion.y());
  // The forehead is left where the brows end: an eighth of it above the glabella.
  const double forehead = glabella.y() + 0.125 * (glabella.y() - gnathion.y());
  const double ears = std::min(landmark(inputs, "tragion_left").z(), landmark(inputs, "tragion_right").z());
  std::vector<int> triangles(region.outer.size(), 0);
  for (const fascia::Triangle& t : skin.triangles) {
    if (std::any_of(t.begin(), t.end(), [&](int v) { return eye[static_cast<size_t>(v)]; })) continue;
    for (const int corner : t)
      if (const int v = region.region_vertex[static_cast<size_t>(corner)]; v >= 0)
        ++triangles[static_cast<size_t>(v)];
  }
  for (const fascia::Triangle& t : region.mesh.triangles)
    for (const int v : t)
      --triangles[static_cast<size_t>(v)];
  std::vector<bool> rim(region.outer.size());
  for (size_t v = 0; v < rim.size(); ++v)
    rim[v] = region.outer[v] && triangles[v] > 0;
  for (const auto& loop : boundary_loops(region.mesh, connectivity(region.mesh)))
    for (const int v : loop) {
      const Vec3& p = region.mesh.vertices[static_cast<size_t>(v)];
      if (region.outer[static_cast<size_t>(v)] && (p.y() < neck || p.y() > forehead || p.z() < ears))
        rim[static_cast<size_t>(v)] = true;
    }
  return rim;
}

/// Where lips and lids lie on a skin that nowhere opens: the vertices nearest to their landmarks.
std::vector<DistanceSeed> feature_seeds(const TissueInputs& inputs, const TriangleMesh& mesh) {
  std::vector<DistanceSeed> seeds;
  for (const char* name : {"cheilion_left", "cheilion_right", "exocanthion_left", "exocanthion_right",
                           "endocanthion_left", "endocanthion_right"}) {
    const Vec3 p = landmark(inputs, name);
    size_t nearest = 0;
    for (size_t v = 1; v < mesh.vertices.size(); ++v)
      if ((mesh.vertices[v] - p).squaredNorm() < (mesh.vertices[nearest] - p).squaredNorm()) nearest = v;
    seeds.push_back({static_cast<int>(nearest)});
  }
  return seeds;
}

}  // namespace

Vestibule::Vestibule(const TissueInputs& inputs) : mechanics_(inputs.mechanics.vestibule) {
  const Vec3 left = landmark(inputs, "cheilion_left"), right = landmark(inputs, "cheilion_right");
  mouth_ = 0.5 * (left + right);
  half_width_ = 0.5 * (left - right).norm();
  top_ = landmark(inputs, "subnasale").y() - mouth_.y();
  bottom_ = mechanics_.lower_fold * (landmark(inputs, "gnathion").y() - mouth_.y());
  for (const size_t side : {0U, 1U}) {
    corners_[side] = side ? left : right;
    to_ears_[side] = landmark(inputs, side ? "tragion_left" : "tragion_right") - corners_[side];
  }
}

double Vestibule::share(const Vec3& p) const {
  const double up = p.y() - mouth_.y(), height = up > 0.0 ? up / top_ : up / bottom_;
  const size_t side = p.x() > mouth_.x();
  const double back = (p - corners_[side]).dot(to_ears_[side]) / to_ears_[side].squaredNorm();
  return mechanics_.back.fall(back) * mechanics_.height.fall(height);
}

double Vestibule::side(const Vec3& p, bool left) const {
  const double blend = mechanics_.midline_blend;
  return 1.0 - smoothstep(-blend, blend, (left ? -1.0 : 1.0) * (p.x() - mouth_.x()) / half_width_);
}

double face_third(const TissueInputs& inputs) {
  return landmark(inputs, "glabella").y() - landmark(inputs, "subnasale").y();
}

Vec3 landmark(const TissueInputs& inputs, const std::string& name) {
  const auto found = inputs.landmarks.find(name);
  if (found == inputs.landmarks.end())
    throw Error("the tissue needs the landmark '" + name + "', which is missing: give it with --landmarks");
  return found->second;
}

rig::Eye eye_of(const TissueInputs& inputs, bool left) {
  const rig::Eye& given = left ? inputs.eye_left : inputs.eye_right;
  if (given.radius > 0.0F) return given;
  const std::string side = left ? "_left" : "_right";
  const Vec3 inner = landmark(inputs, "endocanthion" + side), outer = landmark(inputs, "exocanthion" + side);
  const anatomy::mechanics::Lids& m = inputs.mechanics.lids;
  const double radius = m.globe_radius_share * (outer - inner).norm();
  rig::Eye eye;
  eye.radius = static_cast<float>(radius);
  eye.centre = (0.5 * (inner + outer) - Vec3(0, 0, m.globe_depth_share * radius)).cast<float>();
  return eye;
}

FaceRegion find_region(const TissueInputs& inputs, const TissueOptions& options) {
  const TriangleMesh& skin = inputs.skin;
  std::vector<double> margin(skin.vertices.size());
  for (size_t v = 0; v < margin.size(); ++v)
    margin[v] = margin_at(inputs, skin.vertices[v]);
  std::vector<bool> outer = seen_from_outside(inputs, margin);
  calm(skin, outer);
  const std::vector<bool> eye = eyes_in_skin(inputs);

  std::vector<bool> within(skin.vertices.size());
  for (size_t v = 0; v < within.size(); ++v)
    within[v] = margin[v] > 0.0 && !eye[v];
  // The outer face: what hangs together with the tip of the nose.
  const Vec3 tip = landmark(inputs, "pronasale");
  int start = -1;
  for (size_t v = 0; v < within.size(); ++v)
    if (within[v] && outer[v] &&
        (start < 0 ||
         (skin.vertices[v] - tip).norm() < (skin.vertices[static_cast<size_t>(start)] - tip).norm()))
      start = static_cast<int>(v);
  if (start < 0)
    throw Error("no skin lies between the ears, hairline and chin: check the head's axes and landmarks");
  std::vector<bool> passable(within.size());
  for (size_t v = 0; v < within.size(); ++v)
    passable[v] = within[v] && outer[v];
  const EdgeDistances face = edge_distances(skin, {{start}}, 1e9, passable);

  FaceRegion region;
  std::vector<DistanceSeed> seeds;
  for (size_t v = 0; v < within.size(); ++v)
    if (face.seed[v] >= 0) seeds.push_back({static_cast<int>(v)});
  const EdgeDistances inward = surface_distances(skin, seeds, 0.08, within);
  region.depth = inward.distance;
  region.opening.assign(within.size(), Opening::none);
  for (size_t v = 0; v < within.size(); ++v)
    if (inward.seed[v] >= 0 && face.seed[v] < 0)
      region.opening[v] = opening_at(
          inputs, skin.vertices[static_cast<size_t>(seeds[static_cast<size_t>(inward.seed[v])].vertex)]);

  std::vector<bool> keep(skin.triangles.size());
  for (size_t t = 0; t < keep.size(); ++t) {
    double farthest = 0.0;
    bool at_edge = false;  // the first row of lining stays, however coarse the mesh is
    for (const int corner : skin.triangles[t]) {
      farthest = std::max(farthest, inward.distance[static_cast<size_t>(corner)]);
      at_edge = at_edge || face.seed[static_cast<size_t>(corner)] >= 0;
    }
    keep[t] = farthest <= options.lining || (at_edge && std::isfinite(farthest));
  }
  region.mesh = submesh(skin, keep, &region.region_vertex);
  // Only the piece around the nose: no islands.
  int pieces = 0;
  const std::vector<int> piece = components(region.mesh, &pieces);
  if (pieces > 1) {
    std::vector<int> sizes(static_cast<size_t>(pieces));
    for (const int p : piece)
      ++sizes[static_cast<size_t>(p)];
    const auto largest = static_cast<int>(std::max_element(sizes.begin(), sizes.end()) - sizes.begin());
    std::vector<bool> main_piece(piece.size());
    for (size_t t = 0; t < piece.size(); ++t)
      main_piece[t] = piece[t] == largest;
    std::vector<int> inner_map;
    region.mesh = submesh(region.mesh, main_piece, &inner_map);
    for (int& index : region.region_vertex)
      if (index >= 0) index = inner_map[static_cast<size_t>(index)];
  }
  region.skin_vertex.assign(region.mesh.vertices.size(), -1);
  for (size_t v = 0; v < region.region_vertex.size(); ++v)
    if (region.region_vertex[v] >= 0)
      region.skin_vertex[static_cast<size_t>(region.region_vertex[v])] = static_cast<int>(v);

  region.outer.resize(region.mesh.vertices.size());
  for (size_t v = 0; v < region.outer.size(); ++v)
    region.outer[v] = face.seed[static_cast<size_t>(region.skin_vertex[v])] >= 0;
  const auto neighbours = vertex_neighbours(region.mesh);
  std::vector<DistanceSeed> edges;
  std::array<std::vector<DistanceSeed>, 5> edges_of;
  for (size_t v = 0; v < region.outer.size(); ++v)
    for (const int n : neighbours[v])
      if (region.outer[v] && !region.outer[static_cast<size_t>(n)]) {
        const auto beyond = static_cast<size_t>(region.skin_vertex[static_cast<size_t>(n)]);
        edges.push_back({static_cast<int>(v)});
        edges_of[static_cast<size_t>(region.opening[beyond])].push_back({static_cast<int>(v)});
        break;
      }
  for (const fascia::Triangle& t : skin.triangles) {
    if (std::none_of(t.begin(), t.end(), [&](int v) { return eye[static_cast<size_t>(v)]; })) continue;
    for (const int corner : t)
      if (const int v = region.region_vertex[static_cast<size_t>(corner)];
          v >= 0 && region.outer[static_cast<size_t>(v)]) {
        edges.push_back({v});
        edges_of[static_cast<size_t>(opening_at(inputs, region.mesh.vertices[static_cast<size_t>(v)]))]
            .push_back({v});
      }
  }
  region.rim = rim_of(inputs, skin, region, eye);
  for (const auto& loop : boundary_loops(region.mesh, connectivity(region.mesh)))
    if (const Opening hole = opening_of_loop(inputs, region.mesh, loop); hole != Opening::none)
      for (const int v : loop) {
        if (!region.outer[static_cast<size_t>(v)] || region.rim[static_cast<size_t>(v)]) continue;
        edges.push_back({v});
        edges_of[static_cast<size_t>(hole)].push_back({v});
      }
  if (edges.empty()) edges = feature_seeds(inputs, region.mesh);
  region.feature_distance = finite_distances(region.mesh, edges);
  for (size_t k = 1; k < edges_of.size(); ++k)
    region.opening_distance[k] = finite_distances(region.mesh, edges_of[k]);
  return region;
}

}  // namespace fascia::tissue
