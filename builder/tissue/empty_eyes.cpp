#include "builder/tissue/empty_eyes.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>

#include "builder/spatial/surface_query.h"
#include "builder/tissue/region.h"

namespace fascia::tissue {
namespace {

/// The four places of an eye's lids that landmarks name, going round; nothing when one is missing.
std::optional<std::array<Vec3, 4>> lid_places(const TissueInputs& inputs, const std::string& side) {
  std::array<Vec3, 4> places;
  size_t k = 0;
  for (const char* name : {"exocanthion", "palpebrale_superius", "endocanthion", "palpebrale_inferius"}) {
    const auto found = inputs.landmarks.find(name + side);
    if (found == inputs.landmarks.end()) return {};
    places[k++] = found->second;
  }
  return places;
}

/// What lies between an eye's lids: an ellipse of quarters through the lids' landmarks, before the eye.
struct LidEllipse {
  std::array<Vec3, 4> places;
  Vec3 middle, front;
  double width = 0.0;

  /// A place on it `share` of the way from the middle, at `turn` quarters.
  Vec3 at(double turn, double share) const {
    const double angle = 0.5 * EIGEN_PI * (turn - std::floor(turn));
    const auto from = static_cast<size_t>(turn) % 4;
    return middle + share * (std::cos(angle) * (places[from] - middle) +
                             std::sin(angle) * (places[(from + 1) % 4] - middle));
  }

  /// Whether `p`, seen from the front, lies within `share` of it.
  bool holds(const Vec3& p, double share) const {
    const auto flat = [&](const Vec3& d) { return Vec3(d - d.dot(front) * front); };
    const Vec3 d = flat(p - middle);
    for (size_t k = 0; k < 4; ++k) {
      const Vec3 a = flat(places[k] - middle), b = flat(places[(k + 1) % 4] - middle);
      const double area = a.cross(b).dot(front);
      if (area == 0.0) continue;
      const double along_a = d.cross(b).dot(front) / area, along_b = a.cross(d).dot(front) / area;
      if (along_a >= 0.0 && along_b >= 0.0) return std::hypot(along_a, along_b) < share;
    }
    return false;
  }
};

/// The ellipse of an eye without an eyeball; nothing when it has one, or landmarks are missing or no fissure.
std::optional<LidEllipse> empty_fissure(const TissueInputs& inputs, bool left) {
  const std::string side = left ? "_left" : "_right";
  const bool has_eyeball = std::any_of(inputs.parts.begin(), inputs.parts.end(),
                                       [&](const PartMesh& part) { return part.part == "eye" + side; });
  const auto places = lid_places(inputs, side);
  if (has_eyeball || !places) return {};
  const auto& [outer, upper, inner, lower] = *places;
  const Vec3 lateral = outer - inner;
  LidEllipse ellipse;
  ellipse.places = *places;
  ellipse.middle = 0.25 * (outer + upper + inner + lower);
  ellipse.width = lateral.norm();
  ellipse.front = lateral.cross(upper - lower);
  if (!(ellipse.front.norm() > 1e-3 * ellipse.width * ellipse.width)) return {};
  ellipse.front = ellipse.front.normalized() * (ellipse.front.z() < 0.0 ? -1.0 : 1.0);
  return ellipse;
}

/// Whether what fills the fissure is the eye itself, one surface with its lids; a socket's wall lies far
/// behind it.
bool is_filled(const LidEllipse& ellipse, const spatial::SurfaceQuery& skin) {
  // Of the fissure's width: eyes that are one surface with their lids stand at most a fiftieth behind the
  // lids' edges on heads of eleven makers, the walls of shallow sockets a seventh and more.
  constexpr double empty = 0.08;
  const auto wall =
      skin.first_hit(ellipse.middle + ellipse.width * ellipse.front, -ellipse.front, 4.0 * ellipse.width);
  return wall && wall->distance < (1.0 + empty) * ellipse.width;
}

}  // namespace

std::vector<bool> eyes_in_skin(const TissueInputs& inputs) {
  constexpr double within = 0.9;        // of the way to the lids' edges
  constexpr double least_height = 0.1;  // of its width: lids nearer to each other are closed
  std::vector<bool> eye(inputs.skin.vertices.size(), false);
  const spatial::SurfaceQuery query(inputs.skin);
  for (const bool left : {true, false}) {
    const auto ellipse = empty_fissure(inputs, left);
    if (!ellipse || !is_filled(*ellipse, query)) continue;
    if ((ellipse->places[1] - ellipse->places[3]).norm() < least_height * ellipse->width) continue;
    for (size_t v = 0; v < eye.size(); ++v)
      if ((inputs.skin.vertices[v] - ellipse->middle).norm() < 0.7 * ellipse->width &&
          ellipse->holds(inputs.skin.vertices[v], within))
        eye[v] = true;
  }
  return eye;
}

void hang_curtains(const TissueInputs& inputs, TriangleMesh& blocking) {
  constexpr double margin = 1.12, behind = 0.03;  // of the way to the edges; of the fissure's width
  const spatial::SurfaceQuery query(blocking);
  for (const bool left : {true, false}) {
    const auto ellipse = empty_fissure(inputs, left);
    if (!ellipse || is_filled(*ellipse, query)) continue;
    const Vec3 back = -behind * ellipse->width * ellipse->front;
    const int first = blocking.vertex_count();
    constexpr int corners = 24;
    blocking.vertices.push_back(ellipse->middle + back);
    for (int k = 0; k < corners; ++k) {
      blocking.vertices.push_back(ellipse->at(4.0 * k / corners, margin) + back);
      blocking.triangles.push_back({first, first + 1 + k, first + 1 + (k + 1) % corners});
    }
  }
}

}  // namespace fascia::tissue
