#include "check/examination.h"

#include <algorithm>
#include <cmath>

#include "check/damage.h"
#include "check/eye_turn.h"
#include "check/openings.h"
#include "check/stillness.h"
#include "geometry/error.h"

namespace fascia::check {
namespace {

constexpr const char* side_names[] = {"_left", "_right"};

/// From SI to the unit of a row.
double in_unit(double value, const std::string& unit) {
  if (unit == "mm") return 1e3 * value;
  if (unit == "degrees") return value * 180.0 / EIGEN_PI;
  if (unit == "per_mille") return 1e3 * value;
  return value;
}

/// How far a row's value lies outside its bounds; below 0 inside.
double excess(const Row& row) {
  double out = -1e300;
  if (row.least) out = std::max(out, *row.least - row.value);
  if (row.most) out = std::max(out, row.value - *row.most);
  return out;
}

/// Whether the surface through `vertices` lies behind `centre`, the middle of its curve, as an eye looks.
bool is_hollow(const std::vector<Vec3>& vertices, const Vec3& centre, const Eye& eye) {
  Vec3 middle = Vec3::Zero();
  for (const Vec3& p : vertices)
    middle += p / static_cast<double>(vertices.size());
  return (centre - middle).dot(eye.gaze) > 0.5 * eye.radius;
}

/// Of each vertex the side it is of in the first of `seams` that knows.
std::vector<uint8_t> sides_of(std::initializer_list<const Seam*> seams) {
  std::vector<uint8_t> sides;
  for (const Seam* seam : seams) {
    if (sides.empty()) sides.resize(seam->sides.size(), Seam::none);
    for (size_t v = 0; v < seam->sides.size(); ++v)
      if (sides[v] == Seam::none) sides[v] = seam->sides[v];
  }
  return sides;
}

Vec3 middle_of_face(const Head& head) {
  Vec3 sum = Vec3::Zero();
  int count = 0;
  for (const char* name :
       {"exocanthion_left", "exocanthion_right", "cheilion_left", "cheilion_right", "sellion", "gnathion"})
    if (const auto at = head.landmarks.find(name); at != head.landmarks.end()) {
      sum += at->second;
      ++count;
    }
  if (count == 0)
    throw Error("the rig has no landmarks of the face, so nothing can be checked; build it again");
  return sum / count;
}

}  // namespace

Examination::Examination(const Head& head, const anatomy::Checks& checks, bool is_quick)
    : head_(head),
      checks_(checks),
      sizes_(sizes(head.landmarks, {checks.adult_face, checks.adult_mouth, checks.adult_eye})) {
  constexpr double reach = 2.6;  // times the face's spread: forehead to throat, ear to ear
  skin_ = std::make_unique<Skin>(head, middle_of_face(head), reach * checks.adult_face * sizes_.face);
  if (skin_->rest().triangles.empty())
    throw Error(
        "the rig moves no skin near the landmarks of the face; build it again, with --skin NAME if another "
        "mesh was taken for the skin");
  landmarks_ = std::make_unique<TrackedLandmarks>(*skin_, head.landmarks);
  mouth_ = mouth_seam(*skin_, head.landmarks, sizes_.face);
  for (const bool left : {true, false}) {
    const size_t k = left ? 0 : 1;
    const std::optional<Eye> eye = plausible_eye(head, left);
    if (!eye || !landmarks_->has(std::string("palpebrale_superius") + side_names[k]) ||
        !landmarks_->has(std::string("palpebrale_inferius") + side_names[k]))
      continue;
    lid_seams_[k] = lid_seam(*skin_, head.landmarks, *eye, left);
    lid_looks_[k] = std::make_unique<LidLook>(head, *skin_, *eye, lid_seams_[k], left);
    lids_at_rest_[k] = lid_looks_[k]->look(skin_->rest().vertices, rest_shape(head));
  }
  if (is_quick) return;
  mirror_ = std::make_unique<MirrorPoints>(*skin_, head.landmarks, sizes_.face,
                                           sides_of({&mouth_, &lid_seams_[0], &lid_seams_[1]}));
  crossings_ = crossings_of(*skin_, mouth_, lid_seams_[0], lid_seams_[1], sizes_.face);
  if (!mouth_.empty()) lips_ = std::make_unique<LipLook>(head, *skin_, *landmarks_, sizes_.face);
}

double Examination::size_of(const std::string& scale) const {
  return scale == "face" ? sizes_.face : scale == "mouth" ? sizes_.mouth : scale == "eye" ? sizes_.eye : 1.0;
}

Row Examination::row_of(const anatomy::CheckBound& bound, const std::string& side, double value,
                        double extra) const {
  Row row;
  row.name = bound.row + side;
  row.value = in_unit(value, bound.unit);
  row.unit = bound.unit;
  row.remedy = bound.remedy;
  const double size = size_of(bound.scale);
  if (bound.least) row.least = *bound.least * size;
  if (bound.most) row.most = *bound.most * size + in_unit(extra, bound.unit);
  row.ok = std::isfinite(row.value) && excess(row) <= 0.0;
  return row;
}

void Examination::add(const std::string& bound, const std::string& side, double value,
                      const std::string& pose, std::optional<Vec3> place, double extra) {
  Row row = row_of(checks_.bound(bound), side, value, extra);
  row.pose = pose;
  row.place = place;
  rows_.push_back(std::move(row));
}

void Examination::keep_worst(const std::string& bound, const std::string& side, double value,
                             const std::string& pose, const Vec3& place, double extra) {
  Row row = row_of(checks_.bound(bound), side, value, extra);
  row.pose = pose;
  row.place = place;
  const auto known =
      std::find_if(worst_.begin(), worst_.end(), [&](const Row& r) { return r.name == row.name; });
  if (known == worst_.end())
    worst_.push_back(std::move(row));
  else if (!std::isfinite(row.value) || excess(row) > excess(*known))
    *known = std::move(row);
}

std::vector<Row> Examination::rows() const {
  std::vector<Row> all = rows_;
  all.insert(all.end(), worst_.begin(), worst_.end());
  return all;
}

void Examination::rest(double motion) {
  add("rest.motion", "", motion, "rest");
  poking("rest", skin_->rest().vertices, rest_shape(head_));
}

void Examination::pose(const anatomy::CheckPose& pose, const Shape& shape) {
  double not_finite = 0.0;
  for (const std::vector<Vec3>& part : shape)
    for (const Vec3& p : part)
      not_finite += !p.allFinite();
  keep_worst("finite", "", not_finite, pose.name, Vec3::Zero());
  if (not_finite > 0.0) return;  // nothing else can be measured
  const std::vector<Vec3> skin = skin_->vertices(shape);
  lids(pose.name, skin, shape);
  mouth(pose.name, skin);
  motions(pose.name, skin);
  if (pose.is_symmetric && mirror_) {
    Vec3 place = Vec3::Zero();
    const double worst = mirror_->asymmetry(skin, place);
    keep_worst("mirror", "", worst, pose.name, place);
  }
  crossings(pose.name, skin);
  poking(pose.name, skin, shape);
  damages(pose.name, skin);
  eyes(pose.name, shape);
  still(pose.name, shape);
}

void Examination::lids(const std::string& pose, const std::vector<Vec3>& skin, const Shape& shape) {
  if (pose != "blink" && pose != "wink") return;
  for (size_t k = 0; k < 2; ++k) {
    if (!lid_looks_[k] || lid_seams_[k].empty()) {
      // Both lids are seen nowhere, so nothing says that they close: a failure, not a row left out.
      if (pose == "blink") add("blink.lid_gap", side_names[k], std::nan(""), pose);
      continue;
    }
    const LidState state = lid_looks_[k]->look(skin, shape);
    if (pose == "wink" && k == 1) {  // the right eye stays open
      const double at_rest = lids_at_rest_[k].widest;
      if (at_rest > 0.0) add("wink.other_eye", "", state.widest / at_rest, pose, state.place);
      continue;
    }
    add(pose + ".lid_gap", side_names[k], state.widest, pose, state.place);
    if (pose == "blink") add("blink.cornea_out", side_names[k], state.cornea_out, pose, state.cornea_place);
  }
}

void Examination::mouth(const std::string& pose, const std::vector<Vec3>& skin) {
  if (pose != "jaw_open") return;
  const double parted = 1e-3 * sizes_.mouth;
  const MouthOpening opening = mouth_opening(*skin_, mouth_, skin, parted);
  const auto corner = [&](const char* name) { return landmarks_->at(name, skin); };
  const Vec3 left = corner("cheilion_left"), right = corner("cheilion_right");
  add("jaw_open.parted", "", opening.parted_share, pose, 0.5 * (left + right));
  add("jaw_open.gap", "", opening.most, pose, 0.5 * (left + right));
  if (opening.most <= parted) return;
  add("jaw_open.corner", "_left", opening.corner_left, pose, left);
  add("jaw_open.corner", "_right", opening.corner_right, pose, right);
}

void Examination::motions(const std::string& pose, const std::vector<Vec3>& skin) {
  for (const anatomy::CheckMotion& motion : checks_.motions) {
    if (motion.pose != pose) continue;
    const bool is_single = landmarks_->has(motion.landmark);
    for (size_t k = 0; k < (is_single ? 1 : 2); ++k) {
      const std::string side = is_single ? "" : side_names[k], name = motion.landmark + side;
      if (!landmarks_->has(name)) continue;
      const bool left = !name.ends_with("_right");
      Row row = row_of(motion.bound, side, along(landmarks_->moved(name, skin), motion.direction, left), 0.0);
      row.pose = pose;
      row.place = landmarks_->at(name, skin);
      rows_.push_back(std::move(row));
    }
  }
}

void Examination::crossings(const std::string& pose, const std::vector<Vec3>& skin) {
  for (const Crossings::Kind& kind : crossings_.kinds) {
    Depth worst;
    for (const CrossingPair& pair : kind.pairs)
      worst.take(pair.find(skin));
    const bool is_lid = kind.name.rfind("lids", 0) == 0;
    keep_worst(is_lid ? "crossing.lids" : "crossing." + kind.name, is_lid ? kind.name.substr(4) : "",
               worst.most, pose, worst.place);
  }
}

void Examination::poking(const std::string& pose, const std::vector<Vec3>& skin, const Shape& shape) {
  if (!lips_) return;
  const Poking found = lips_->look(skin, shape);
  if (lips_->has_teeth()) keep_worst("crossing.teeth", "", found.teeth.most, pose, found.teeth.place);
  keep_worst("crossing.lining", "", found.lining.most, pose, found.lining.place);
}

void Examination::damages(const std::string& pose, const std::vector<Vec3>& skin) {
  constexpr double least_edge = 3e-4;  // metres: what is shorter cannot be seen
  const Damage found = damage(*skin_, skin, least_edge * sizes_.face);
  const double count = static_cast<double>(skin_->rest().triangles.size());
  keep_worst("triangles.turned", "", found.turned / count, pose, found.turned_place);
  keep_worst("edges.stretched", "", found.stretched / (1.5 * count), pose, found.stretched_place);
  keep_worst("edges.longest", "", found.longest, pose, found.stretched_place);
}

void Examination::eyes(const std::string& pose, const Shape& shape) {
  if (pose != "look_left") return;
  for (size_t k = 0; k < 2; ++k) {
    size_t ball = head_.parts.size();
    for (size_t p = 0; p < head_.parts.size(); ++p)
      if (head_.parts[p].name == std::string("eye") + side_names[k] &&
          (ball == head_.parts.size() ||
           head_.parts[p].mesh.vertices.size() > head_.parts[ball].mesh.vertices.size()))
        ball = p;
    if (ball == head_.parts.size()) continue;
    Vec3 centre;
    double radius = 0.0;
    const std::vector<Vec3>& rest = head_.parts[ball].mesh.vertices;
    const std::optional<Eye> eye = plausible_eye(head_, k == 0);
    // A plate a little bent, as drawn faces have for eyes, or one that is hollow to the front, lies on the
    // sphere of no eyeball: it turns about the globe behind it.
    constexpr double largest = 2.0;  // of the globe
    if (!sphere_centre(rest, centre, radius) || (eye && radius > largest * eye->radius) ||
        (eye && is_hollow(rest, centre, *eye))) {
      if (!eye) continue;
      centre = eye->centre;
    }
    const EyeTurn turn = eye_turn(rest, shape[ball], centre);
    add("look_left.turn", side_names[k], turn.yaw, pose, centre);
    add("look_left.centre", side_names[k], turn.off_centre, pose, centre);
    add("look_left.rigid", side_names[k], turn.bent, pose, centre);
  }
}

void Examination::still(const std::string& pose, const Shape& shape) {
  for (const Stillness& one : stillness(head_, shape, 0.06 * sizes_.face))
    keep_worst("still." + one.name, "", one.most, pose, one.place);
}

}  // namespace fascia::check
