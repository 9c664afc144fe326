#include "builder/landmarks/symmetry.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <vector>

namespace fascia::landmarks {
namespace {

std::string other_side(const std::string& name) {
  return name.ends_with("_left") ? name.substr(0, name.size() - 4) + "right" : std::string();
}

/// Calls `visit` for the landmarks of each pair, left first.
template <class Landmarks, class Visit>
void for_each_pair(Landmarks& landmarks, Visit visit) {
  for (auto& [name, left] : landmarks)
    if (const auto right = landmarks.find(other_side(name)); right != landmarks.end())
      visit(left, right->second);
}

/// Places on the skin among the landmarks: these, and middles between neighbours by name, both sides alike.
std::vector<Vec3> places_of(const std::map<std::string, SkinLandmark>& landmarks,
                            const spatial::SurfaceQuery& skin) {
  constexpr double off = 0.006;  // metres: what is farther from the skin is beside the mesh
  std::vector<Vec3> lefts, rights, places;
  for_each_pair(landmarks, [&](const SkinLandmark& left, const SkinLandmark& right) {
    lefts.push_back(left.position);
    rights.push_back(right.position);
  });
  for (const std::vector<Vec3>* side : {&lefts, &rights})
    for (size_t i = 0; i < side->size(); ++i)
      for (const size_t step : {size_t{0}, size_t{1}, size_t{5}}) {
        const Vec3 p = 0.5 * ((*side)[i] + (*side)[(i + step) % side->size()]);
        if (const auto hit = skin.closest(p, off); hit.found()) places.push_back(hit.position);
      }
  return places;
}

/// A millimetre in proportion to the face.
double unit_of(const std::map<std::string, SkinLandmark>& landmarks, double adult_width) {
  const auto left = landmarks.find("exocanthion_left"), right = landmarks.find("exocanthion_right");
  if (left == landmarks.end() || right == landmarks.end()) return 0.001;
  return spatial::adult_millimetre(left->second.position, right->second.position, adult_width);
}

/// The place of the skin on the plane that is nearest to `from`, by going from one to the other in turn, as
/// on the ridge of a nose: nothing where they do not meet within `near`.
std::optional<Vec3> along_plane(const MirrorPlane& plane, const spatial::SurfaceQuery& skin, const Vec3& from,
                                double near) {
  constexpr int rounds = 60;
  Vec3 p = from;
  for (int round = 0; round < rounds; ++round) {
    const Vec3 foot = plane.foot(p);
    const auto hit = skin.closest(foot);
    if (!hit.found()) return {};
    p = hit.position;
    if (hit.distance < 0.1 * near) break;
  }
  if (std::abs(plane.distance(p)) > near) return {};
  return p;
}

}  // namespace

std::optional<FaceMirror> face_mirror(const std::map<std::string, SkinLandmark>& landmarks,
                                      const spatial::SurfaceQuery& skin, double adult_width) {
  constexpr double within = 8.0, alike = 2.0, exact = 0.35;  // millimetres of an adult's face
  std::vector<std::pair<Vec3, Vec3>> pairs;
  for_each_pair(landmarks, [&](const SkinLandmark& left, const SkinLandmark& right) {
    pairs.emplace_back(left.position, right.position);
  });
  const auto plane = spatial::plane_between(pairs);
  if (pairs.size() < 3 || !plane) return {};
  const double unit = unit_of(landmarks, adult_width);
  const std::vector<Vec3> places = places_of(landmarks, skin);
  const spatial::MirrorFit fit = spatial::fit_mirror_plane(skin, places, *plane, within * unit);
  const double most = fit.most_apart();
  if (!fit.covers(places.size())) return {};
  return FaceMirror{fit.plane, most <= alike * unit, most <= exact * unit, unit};
}

int make_symmetric(const FaceMirror& mirror, const spatial::SurfaceQuery& skin,
                   std::map<std::string, SkinLandmark>& landmarks) {
  const MirrorPlane& plane = mirror.plane;
  const double unit = mirror.unit, near = 0.6 * unit, far = (mirror.is_exact ? 5.0 : 3.0) * unit;
  const double least = mirror.is_exact ? 0.0 : far;
  int moved = 0;
  // Beside the mesh, as a mask's ears are, a landmark is as far from the skin as it was.
  const auto settled = [&](const Vec3& p, const SkinLandmark& before) -> std::optional<Vec3> {
    const auto was = skin.closest(before.position, near);
    if (!was.found()) return p;
    const auto hit = skin.closest(p, near);
    if (!hit.found()) return {};
    return hit.position;
  };
  for_each_pair(landmarks, [&](SkinLandmark& left, SkinLandmark& right) {
    if (left.is_given || right.is_given) return;
    const Vec3 image = plane.image(right.position);
    // Found apart, one of them was found wrong: the surer one counts.
    const double apart = (left.position - image).norm();
    const bool is_left_surer = left.confidence >= right.confidence;
    // A landmark less sure than its image would bend the skull to one side.
    left.confidence = right.confidence = apart > far ? std::max(left.confidence, right.confidence)
                                                     : 0.5 * (left.confidence + right.confidence);
    if (apart < least) return;
    const Vec3 surer = is_left_surer ? left.position : image, mean = 0.5 * (left.position + image);
    for (const Vec3& p : {apart > far ? surer : mean, surer}) {  // a mean may lie in the air beside a fold
      const auto here = settled(p, left), there = settled(plane.image(p), right);
      if (!here || !there) continue;
      left.position = *here;
      right.position = *there;
      moved += 2;
      return;
    }
  });
  for (auto& [name, landmark] : landmarks) {
    if (name.ends_with("_left") || name.ends_with("_right") || landmark.is_given ||
        std::abs(plane.distance(landmark.position)) < least)
      continue;
    const Vec3 p = plane.foot(landmark.position);
    const auto here = settled(p, landmark);
    if (const auto place = here ? here : along_plane(plane, skin, landmark.position, near)) {
      landmark.position = *place;
      ++moved;
    }
  }
  return moved;
}

Mat3 upright(const MirrorPlane& plane) {
  return Eigen::Quaterniond::FromTwoVectors(plane.normal, Vec3::UnitX()).toRotationMatrix();
}

}  // namespace fascia::landmarks
