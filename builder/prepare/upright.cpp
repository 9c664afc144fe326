#include "builder/prepare/upright.h"

#include <Eigen/Geometry>
#include <cmath>

namespace fascia::prepare {
namespace {

/// Left minus right of all landmarks that come in pairs, summed: those far apart tell most, and one that is
/// misplaced little.
Vec3 lateral_of(const std::map<std::string, Vec3>& points, int& pairs) {
  Vec3 sum = Vec3::Zero();
  pairs = 0;
  for (const auto& [name, left] : points) {
    if (!name.ends_with("_left")) continue;
    const auto right = points.find(name.substr(0, name.size() - 4) + "right");
    if (right == points.end()) continue;
    sum += left - right->second;
    ++pairs;
  }
  return sum;
}

/// The turn about the lateral axis that brings `here` onto `reference` best, both seen from the side.
double nod_between(const std::map<std::string, Vec3>& here, const Mat3& turned,
                   const std::map<std::string, Vec3>& reference) {
  Vec3 from_mean = Vec3::Zero(), to_mean = Vec3::Zero();
  double count = 0.0;
  for (const auto& [name, p] : here)
    if (const auto at = reference.find(name); at != reference.end()) {
      from_mean += turned * p;
      to_mean += at->second;
      count += 1.0;
    }
  double along = 0.0, across = 0.0;
  for (const auto& [name, p] : here)
    if (const auto at = reference.find(name); at != reference.end()) {
      const Vec3 from = turned * p - from_mean / count, to = at->second - to_mean / count;
      along += from.y() * to.y() + from.z() * to.z();
      across += from.y() * to.z() - from.z() * to.y();
    }
  return std::atan2(across, along);
}

}  // namespace

Mat3 uprighting(const std::map<std::string, Vec3>& here, const std::map<std::string, Vec3>& reference) {
  int pairs = 0;
  const Vec3 lateral = lateral_of(here, pairs);
  if (pairs < 3 || !(lateral.norm() > 1e-3 * pairs)) return Mat3::Identity();
  const Mat3 level = Eigen::Quaterniond::FromTwoVectors(lateral, Vec3::UnitX()).toRotationMatrix();
  const double nod = nod_between(here, level, reference);
  return Eigen::AngleAxisd(nod, Vec3::UnitX()).toRotationMatrix() * level;
}

void turn(PreparedHead& head, const Mat3& rotation) {
  const auto turn_all = [&](std::vector<Vec3>& points) {
    for (Vec3& p : points)
      p = rotation * p;
  };
  for (PreparedMesh& mesh : head.meshes)
    turn_all(mesh.positions);
  turn_all(head.skin.vertices);
  head.surface.emplace(head.skin);
  for (auto& [name, p] : head.landmarks)
    p = rotation * p;
  for (std::optional<Eyeball>* eye : {&head.eye_left, &head.eye_right})
    if (*eye) {
      (*eye)->centre = rotation * (*eye)->centre;
      (*eye)->gaze = rotation * (*eye)->gaze;
    }
  Mat4 map = Mat4::Identity();
  map.topLeftCorner<3, 3>() = rotation;
  head.input_to_metres = map * head.input_to_metres;
}

}  // namespace fascia::prepare
