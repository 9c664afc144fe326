#include "builder/landmarks/complete.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "builder/splines/warp.h"
#include "geometry/error.h"

namespace fascia::landmarks {

namespace {

[[noreturn]] void fail_for_lack(const Landmarks& given, const anatomy::GenericAnatomy& anatomy) {
  std::string missing;
  for (const anatomy::Landmark& landmark : anatomy.landmarks)
    if (landmark.required && !given.count(landmark.name))
      missing += (missing.empty() ? "" : ", ") + landmark.name;
  throw Error(
      "too few landmarks to place the rest: four or more are needed that do not lie in one plane; required "
      "ones missing: " +
      missing);
}

}  // namespace

std::optional<spatial::ClosestPoint> facing_point(const spatial::SurfaceQuery& skin, const Vec3& carried,
                                                  const Vec3& normal) {
  const spatial::ClosestPoint near = skin.closest(carried);
  if (near.found() && near.pseudonormal.dot(normal) > 0.3) return near;
  const double reach = 0.015;
  if (const auto hit = skin.first_hit(carried + reach * normal, -normal, 2.0 * reach))
    return skin.closest(hit->position);
  if (near.found()) return near;
  return std::nullopt;
}

std::map<std::string, SkinLandmark> complete(const Landmarks& given, const anatomy::GenericAnatomy& anatomy,
                                             const spatial::SurfaceQuery& skin,
                                             std::vector<std::string>* unknown) {
  std::map<std::string, SkinLandmark> all;
  std::vector<Vec3> generic, here;
  for (const auto& [name, p] : given) {
    const anatomy::Landmark* known = anatomy.landmark(name);
    if (!known || !known->skin) {
      if (unknown) unknown->push_back(name);
      continue;
    }
    all[name] = {p, 1.0, true};
    // Landmarks that coincide on the generic head (one point under two names) steer once.
    const bool repeats = std::any_of(generic.begin(), generic.end(),
                                     [&](const Vec3& q) { return (q - *known->skin).norm() < 1e-4; });
    if (!repeats) {
      generic.push_back(*known->skin);
      here.push_back(p);
    }
  }
  if (generic.size() < 4) fail_for_lack(given, anatomy);
  splines::WarpOptions options;
  options.lambda = 1e-5;  // points placed by hand are a fraction of a millimetre off
  const splines::Warp warp = splines::fit_warp(generic, here, options);
  for (const anatomy::Landmark& landmark : anatomy.landmarks) {
    if (!landmark.skin || all.count(landmark.name)) continue;
    const Vec3 carried = warp(*landmark.skin);
    const Mat3 turn = warp.jacobian(*landmark.skin);
    Vec3 normal = landmark.normal;
    if (std::abs(turn.determinant()) > 1e-6) normal = turn.inverse().transpose() * normal;
    normal.normalize();
    const auto place = facing_point(skin, carried, normal);
    if (!place) continue;
    double nearest = 1e300;
    for (const Vec3& p : generic)
      nearest = std::min(nearest, (p - *landmark.skin).norm());
    const double confidence =
        std::clamp(0.9 * std::exp(-nearest / 0.04) * std::exp(-place->distance / 0.008), 0.01, 0.9);
    all[landmark.name] = {place->position, confidence, false};
  }
  return all;
}

}  // namespace fascia::landmarks
