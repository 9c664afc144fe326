#include "builder/smas/reach.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <initializer_list>

#include "builder/spatial/surface_query.h"
#include "geometry/connectivity.h"
#include "geometry/error.h"

namespace fascia::smas {

namespace {

const Vec3& landmark(const Landmarks& landmarks, const std::string& name) {
  const auto found = landmarks.find(name);
  if (found == landmarks.end())
    throw Error("SMAS: landmark '" + name + "' is missing; find or give the landmarks of the face first");
  if (!found->second.allFinite()) throw Error("SMAS: landmark '" + name + "' is not a finite point");
  return found->second;
}

// Rules that tell the openings' lining from the skin around them, and stand-ins for landmarks that are not
// given. Lengths in metres of an adult; they describe how heads are modelled, not how faces are made.
constexpr double kLeastOpening = 0.0025;  // half height of closed lids and lips
constexpr double kLidCorner = 1.3;        // margin beside the canthi over that above and below the fissure
constexpr double kEyeDepth = 0.020;       // before and behind the canthi an eye's opening reaches
constexpr double kMouthFront = 0.020, kMouthBack = 0.030;      // before and behind the lips the mouth's does
constexpr double kNostrilFront = 0.008, kNostrilBack = 0.004;  // before and behind the nostrils' rims
constexpr double kNostrilRadius = 0.9;  // of the way up a nostril, in lengths of its rim
constexpr double kNostrilHeight = 0.025, kNostrilBelow = 0.002;  // of that way, above and below the rim
constexpr double kGlobe = 0.012;           // half of an adult's 24 mm (Gray's Anatomy, 41st ed.)
constexpr double kBrowToHairline = 0.048;  // without a trichion: above glabella
constexpr double kHairlineToVertex = 0.1;  // and along the scalp from there

Vec3 perpendicular(const Vec3& v, const Vec3& axis) {
  return (v - axis * axis.dot(v)).normalized();
}

}  // namespace

anatomy::mechanics::SmasShape with_options(anatomy::mechanics::SmasShape shape, const ReachOptions& options) {
  shape.galea = options.galea.value_or(shape.galea);
  shape.neck = options.neck.value_or(shape.neck);
  return shape;
}

double face_scale(const Landmarks& landmarks, const anatomy::mechanics::SmasShape& shape) {
  const Vec3 &left = landmark(landmarks, "exocanthion_left"),
             &right = landmark(landmarks, "exocanthion_right");
  const double height = (landmark(landmarks, "gnathion") - 0.5 * (left + right)).norm();
  const double scale = 0.5 * ((left - right).norm() / shape.adult_width + height / shape.adult_height);
  if (!(scale > 1e-3)) throw Error("SMAS: exocanthion_left, exocanthion_right and gnathion lie at one point");
  return scale;
}

double ReachField::Opening::distance(const Vec3& point) const {
  const double depth = (point - centre).dot(z);
  return std::max({across(point), near - depth, depth - far});
}

double ReachField::Opening::across(const Vec3& point) const {
  const Vec3 r = point - centre;
  const double u = r.dot(x), v = r.dot(y) - bend * u * u;
  const double height = v > 0.0 ? up : down;
  const Vec2 scaled(u / half_width, v / height);
  const double level = scaled.norm();
  // First-order distance (F - 1) / |grad F| of F = |scaled|.
  const Vec2 gradient(scaled[0] / half_width, scaled[1] / height);
  const double slope = gradient.norm() / std::max(level, 1e-9);
  return slope > 0.0 ? std::max((level - 1.0) / slope, -std::min(up, down)) : -std::min(up, down);
}

ReachField::ReachField(const Landmarks& landmarks, const anatomy::mechanics::SmasShape& shape, bool nostrils,
                       double band)
    : shape_(shape), scale_(face_scale(landmarks, shape)), band_(band) {
  for (const char* side : {"_left", "_right"})
    add_eye(landmarks, side);
  add_mouth(landmarks);
  if (nostrils) add_nostrils(landmarks);
  add_limits(landmarks);
}

void ReachField::add_eye(const Landmarks& landmarks, const std::string& side) {
  const double margin = shape_.lid_margin * scale_;
  const Vec3 &outer = landmark(landmarks, "exocanthion" + side),
             &inner = landmark(landmarks, "endocanthion" + side);
  const Vec3 &above = landmark(landmarks, "palpebrale_superius" + side),
             &below = landmark(landmarks, "palpebrale_inferius" + side);
  Opening eye;
  eye.centre = 0.5 * (outer + inner);
  eye.x = (side == "_left" ? outer - inner : inner - outer).normalized();
  // The globe bulges between the canthi: up is across them towards the upper lid, as seen from the front.
  const Vec3 up = landmark(landmarks, "nasion") - landmark(landmarks, "subnasale");
  eye.y = perpendicular(up, eye.x);
  eye.z = eye.x.cross(eye.y);
  eye.half_width = 0.5 * (outer - inner).norm() + kLidCorner * margin;
  const double least = kLeastOpening * scale_;
  eye.up = std::max((above - eye.centre).dot(eye.y), least) + margin;
  eye.down = std::max(-(below - eye.centre).dot(eye.y), least) + margin;
  eye.bend = 0.0;
  eye.near = -kEyeDepth * scale_, eye.far = kEyeDepth * scale_;
  eye.globe = kGlobe * scale_;
  openings_.push_back(eye);
}

void ReachField::add_mouth(const Landmarks& landmarks) {
  const Vec3 &left = landmark(landmarks, "cheilion_left"), &right = landmark(landmarks, "cheilion_right");
  const Vec3& between = landmark(landmarks, "stomion");
  const Vec3 &above = landmark(landmarks, "labiale_superius"),
             &below = landmark(landmarks, "labiale_inferius");
  Opening mouth;
  mouth.x = (left - right).normalized();
  mouth.y = perpendicular(above - below, mouth.x);
  mouth.z = mouth.x.cross(mouth.y);
  mouth.centre = between + mouth.x * mouth.x.dot(0.5 * (left + right) - between);
  const double corner = 0.5 * (left - right).norm();
  mouth.bend = (0.5 * (left + right) - mouth.centre).dot(mouth.y) / (corner * corner);
  mouth.half_width = corner + shape_.lip_corner * scale_;
  const double least = kLeastOpening * scale_;
  mouth.up = std::max(shape_.lip_part * (above - between).dot(mouth.y), least);
  mouth.down = std::max(shape_.lip_part * (between - below).dot(mouth.y), least);
  mouth.near = -kMouthBack * scale_, mouth.far = kMouthFront * scale_;
  openings_.push_back(mouth);
}

// One opening for both nostrils: the columella between them is narrower than two triangles.
void ReachField::add_nostrils(const Landmarks& landmarks) {
  const Vec3 &under = landmark(landmarks, "subnasale"), &tip = landmark(landmarks, "pronasale");
  const Vec3* columella = find_landmark(landmarks, "columella");
  const Vec3 front = columella ? *columella : Vec3(0.6 * under + 0.4 * tip);
  Vec3 centres[2];
  double length = 0.0;
  for (int k = 0; k < 2; ++k) {
    const std::string side = k == 0 ? "_left" : "_right";
    const Vec3& ala = landmark(landmarks, "alare" + side);
    const Vec3* subalare = find_landmark(landmarks, "subalare" + side);
    const Vec3 rear = subalare ? *subalare : Vec3(0.75 * ala + 0.25 * under);
    centres[k] = 0.35 * rear + 0.5 * front + 0.15 * ala;
    length += 0.5 * (front - rear).norm();
  }
  Opening nose;
  nose.centre = 0.5 * (centres[0] + centres[1]);
  nose.x = (centres[0] - centres[1]).normalized();
  // Out of the nostrils is down and forward, across the line from lip to tip.
  nose.z = nose.x.cross(tip - under).normalized();
  if (nose.z.dot(under - landmark(landmarks, "nasion")) < 0.0) nose.z = -nose.z;
  nose.y = nose.z.cross(nose.x);
  // As wide as the alae, including their lowest part: their free edges are thinner than a triangle.
  const double wings = (landmark(landmarks, "alare_left") - landmark(landmarks, "alare_right")).norm();
  nose.half_width =
      std::max(0.5 * wings, 0.5 * (centres[0] - centres[1]).norm() + shape_.nostril_width * length);
  nose.up = nose.down = shape_.nostril_height * length;
  // Bent, so that it passes in front of subnasale and back into the nostrils beside it.
  const double ahead = std::max((under - nose.centre).dot(nose.y) + 1.2 * nose.down, 0.0);
  nose.centre += ahead * nose.y;
  nose.bend = -1.5 * ahead / (nose.half_width * nose.half_width);
  nose.near = -kNostrilBack * scale_, nose.far = kNostrilFront * scale_;
  openings_.push_back(nose);
  for (const Vec3& rim : centres)
    nostrils_.push_back({rim, nose.z, kNostrilRadius * length});
}

bool ReachField::in_nostril(const Vec3& point, const Vec3& normal) const {
  for (const Nostril& nostril : nostrils_) {
    const Vec3 inwards = nostril.rim - point;
    const double along = inwards.dot(nostril.out);
    const Vec3 across = inwards - along * nostril.out;
    if (along < -kNostrilBelow * scale_ || along > kNostrilHeight * scale_ || across.norm() > nostril.radius)
      continue;
    if (normal.dot(across) > 0.15 * across.norm()) return true;
  }
  return false;
}

void ReachField::add_limits(const Landmarks& landmarks) {
  const Vec3 &left = landmark(landmarks, "exocanthion_left"),
             &right = landmark(landmarks, "exocanthion_right");
  const Vec3 side = (left - right).normalized();
  const Vec3 &chin = landmark(landmarks, "gnathion"), &root = landmark(landmarks, "nasion");
  const Vec3 up = perpendicular(root - chin, side), front = side.cross(up);
  // In front of the ears: a plane across the head through the foremost of the ears' landmarks.
  double foremost = -1e300;
  for (const char* name : {"tragion_left", "tragion_right"})
    foremost = std::max(foremost, landmark(landmarks, name).dot(front));
  for (const char* name :
       {"preaurale_left", "preaurale_right", "otobasion_superius_left", "otobasion_superius_right"})
    if (const Vec3* ear = find_landmark(landmarks, name)) foremost = std::max(foremost, ear->dot(front));
  limits_.push_back({front * (foremost + shape_.ear_gap * scale_), front});
  // Behind the hairline.
  if (const Vec3* hairline = find_landmark(landmarks, "trichion")) {
    const Vec3* top = find_landmark(landmarks, "vertex");
    const Vec3 crown = top ? *top : Vec3(*hairline + scale_ * (0.040 * up - 0.095 * front));
    const Vec3 along = perpendicular(crown - *hairline, side);
    limits_.push_back({*hairline + shape_.galea * (crown - *hairline), -along});
  } else {
    const Vec3& brow = landmark(landmarks, "glabella");
    limits_.push_back({brow + (kBrowToHairline + kHairlineToVertex * shape_.galea) * scale_ * up, -up});
  }
  // Along the neck: down from the angle of chin and neck.
  const Vec3* angle = find_landmark(landmarks, "cervicale");
  const Vec3 throat = angle ? *angle : Vec3(chin - scale_ * (0.011 * up + 0.04 * front));
  limits_.push_back({throat - shape_.neck * scale_ * up, up});
}

double ReachField::within_limits(const Vec3& skin) const {
  double value = 1.0;
  for (const Limit& limit : limits_)
    value = std::min(value, (skin - limit.at).dot(limit.inward));
  return value;
}

double ReachField::outside_openings(const Vec3& skin) const {
  double value = 1.0;
  for (const Opening& opening : openings_) {
    double distance = opening.distance(skin);
    // Stretched inside, so that every opening leaves its skin before its middle.
    if (distance < 0.0) distance *= band_ / std::min(band_, 0.55 * std::min(opening.up, opening.down));
    value = std::min(value, distance);
  }
  return value;
}

bool ReachField::may_be_lining(const Vec3& point, const Vec3& normal) const {
  for (const Opening& opening : openings_) {
    const double depth = (point - opening.centre).dot(opening.z);
    if (normal.dot(opening.z) < 0.35 && depth > -0.035 * scale_ && depth < 0.01 * scale_ &&
        opening.across(point) < 0.005 * scale_)
      return true;
  }
  return in_nostril(point, normal);
}

bool ReachField::is_socket(const Vec3& point, const Vec3& normal) const {
  for (const Opening& opening : openings_) {
    if (!(opening.globe > 0.0)) continue;
    // Lids, temple and the side of the nose face away from the globe, or are in front of it and beside.
    const Vec3 from_globe = point - (opening.centre - 0.8 * opening.globe * opening.z);
    const double depth = (point - opening.centre).dot(opening.z), distance = from_globe.norm();
    const double facing = -normal.dot(from_globe) / std::max(distance, 1e-12);
    if (distance < 1.5 * opening.globe && facing > 0.2) return true;
    if (distance < 2.1 * opening.globe && facing > 0.45) return true;
    if (depth < -0.3 * opening.globe && distance < 2.7 * opening.globe && facing > 0.0) return true;
  }
  return false;
}

bool ReachField::near_opening(const Vec3& point) const {
  for (const Opening& opening : openings_)
    if ((point - opening.centre).norm() < opening.half_width + 0.04 * scale_) return true;
  return false;
}

FacialSkin facial_skin(const TriangleMesh& skin, const Landmarks& landmarks, const ReachField& field,
                       double band) {
  std::vector<double> limits(skin.vertices.size()), openings(skin.vertices.size());
  for (size_t v = 0; v < limits.size(); ++v) {
    limits[v] = field.within_limits(skin.vertices[v]);
    openings[v] = field.outside_openings(skin.vertices[v]);
  }
  // Large triangles may reach far over the outer limit, but must not bridge an opening.
  std::vector<bool> keep(skin.triangles.size(), false);
  for (int t = 0; t < skin.triangle_count(); ++t) {
    const auto& [a, b, c] = skin.triangles[t];
    keep[t] = std::max({limits[a], limits[b], limits[c]}) > -band &&
              std::min({openings[a], openings[b], openings[c]}) > -band;
  }
  // Lining looks at other skin close by: only the skin around the openings matters for that.
  std::vector<bool> around(skin.triangles.size(), false);
  for (int t = 0; t < skin.triangle_count(); ++t)
    around[t] = field.near_opening(skin.vertices[skin.triangles[t][0]]);
  if (std::find(around.begin(), around.end(), true) == around.end())
    throw Error("SMAS: no skin near eyes and mouth; check that the landmarks lie on the head");
  const spatial::SurfaceQuery query(submesh(skin, around, nullptr));
  const double near = 1e-4 * field.scale(), far = 0.03 * field.scale();
  for (int t = 0; t < skin.triangle_count(); ++t) {
    if (!keep[t]) continue;
    const Triangle& c = skin.triangles[t];
    const Vec3 middle = (skin.vertices[c[0]] + skin.vertices[c[1]] + skin.vertices[c[2]]) / 3.0;
    const Vec3 normal = triangle_normal(skin, t);
    if (field.is_socket(middle, normal)) keep[t] = false;
    if (field.may_be_lining(middle, normal) && normal.norm() > 0.5 &&
        query.first_hit(middle + near * normal, normal, far))
      keep[t] = false;
  }
  // The part that holds the triangle next to glabella.
  const Connectivity links = connectivity(skin);
  const Vec3& start = landmark(landmarks, "glabella");
  int first = -1;
  double nearest = 1e300;
  for (int t = 0; t < skin.triangle_count(); ++t) {
    if (!keep[t]) continue;
    const Triangle& c = skin.triangles[t];
    const double d =
        ((skin.vertices[c[0]] + skin.vertices[c[1]] + skin.vertices[c[2]]) / 3.0 - start).squaredNorm();
    if (d < nearest) nearest = d, first = t;
  }
  if (first < 0)
    throw Error(
        "SMAS: no skin of the face between ears, hairline and neck; check that the landmarks lie on the "
        "head");
  std::vector<bool> reached(skin.triangles.size(), false);
  std::vector<int> stack = {first};
  reached[first] = true;
  while (!stack.empty()) {
    const int t = stack.back();
    stack.pop_back();
    for (int n : links.neighbours[t])
      if (n >= 0 && keep[n] && !reached[n]) reached[n] = true, stack.push_back(n);
  }
  FacialSkin face;
  std::vector<int> map;
  face.mesh = submesh(skin, reached, &map);
  face.field.resize(face.mesh.vertices.size());
  for (size_t v = 0; v < map.size(); ++v)
    if (map[v] >= 0) face.field[map[v]] = std::min(limits[v], openings[v]);
  for (int t = 0; t < skin.triangle_count(); ++t)
    if (reached[t]) face.skin_triangle.push_back(t);
  return face;
}

}  // namespace fascia::smas
