#include "builder/landmarks/find.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

namespace fascia::landmarks {

namespace {

/// Open samples about the head: dense over the face, sparse elsewhere.
Samples head_samples(const GenericFace& face, const spatial::SurfaceQuery& skin, const Placement& placement, int face_count,
                     int head_count) {
  const Ball front{placement(Vec3(0, -0.005, 0.085)), 0.085 * placement.scale};
  const Ball head{placement(face.vault.centre), 1.75 * face.vault.radius * placement.scale};
  Samples all = open_samples(sample_evenly(skin.mesh(), face_count, front), skin);
  const Samples wide = open_samples(sample_evenly(skin.mesh(), head_count, head), skin);
  for (size_t i = 0; i < wide.size(); ++i)
    if ((wide.points[i] - front.centre).norm() > front.radius) all.add(wide.points[i], wide.normals[i]);
  return all;
}

/// Normal of the generic head at `at`, carried by the fit.
Vec3 carried_normal(const Registration& fit, const Vec3& at, const Vec3& normal) {
  const Mat3 turn = fit.warp.jacobian(at);
  const Vec3 bent = std::abs(turn.determinant()) > 1e-6 ? Vec3(turn.inverse().transpose() * normal) : normal;
  return (fit.placement.rotation * bent).normalized();
}

/// What the fit leaves about a generic point: weighted mean residual, metres, and agreement of normals.
double confidence_at(const GenericFace& face, const Registration& fit, const Vec3& at) {
  double sum = 0.0, total = 0.0;
  for (size_t i = 0; i < fit.used.size(); ++i) {
    const double off = (face.points.points[static_cast<size_t>(fit.used[i])] - at).norm();
    if (off > 0.03) continue;
    const double weight = std::exp(-0.5 * off * off / (0.01 * 0.01));
    const double near = std::exp(-fit.residuals[i] / 0.0025) * std::clamp(fit.agreements[i] * 1.25, 0.0, 1.0);
    sum += weight * near;
    total += weight;
  }
  return total > 0.0 ? std::clamp(0.97 * sum / total, 0.01, 0.97) : 0.01;
}

}  // namespace

std::map<std::string, Vec3> rough_landmarks(const GenericFace& face, const anatomy::GenericAnatomy& anatomy,
                                            const TriangleMesh& mesh, const FoundHead& found) {
  const spatial::SurfaceQuery surface(found.is_inside_out ? turned_over(mesh) : mesh);
  const Placement& placement = found.placement;
  RegistrationOptions coarse;
  coarse.stride = 2;
  coarse.lambdas = {10, 3, 1};
  const Registration fit = register_face(face, head_samples(face, surface, placement, 6000, 4000), placement, {}, coarse);
  std::map<std::string, Vec3> rough;
  for (const anatomy::Landmark& landmark : anatomy.landmarks) {
    if (!landmark.skin || !landmark.required) continue;
    const auto place = facing_point(surface, fit(*landmark.skin), carried_normal(fit, *landmark.skin, landmark.normal));
    if (place) rough[landmark.name] = place->position;
  }
  return rough;
}

std::map<std::string, SkinLandmark> find(const GenericFace& face, const anatomy::GenericAnatomy& anatomy,
                                         const spatial::SurfaceQuery& skin, const Placement& placement,
                                         const std::map<std::string, Vec3>& given, std::vector<std::string>* unknown) {
  std::map<std::string, SkinLandmark> all;
  std::vector<Anchor> anchors;
  for (const auto& [name, p] : given) {
    const anatomy::Landmark* known = anatomy.landmark(name);
    if (!known || !known->skin) {
      if (unknown) unknown->push_back(name);
      continue;
    }
    all[name] = {p, 1.0, true};
    const bool repeats = std::any_of(anchors.begin(), anchors.end(), [&](const Anchor& a) { return (a.generic - *known->skin).norm() < 1e-3; });
    if (!repeats) anchors.push_back({*known->skin, p, 100.0});
  }
  const Samples samples = head_samples(face, skin, placement, 14000, 5000);
  const Registration fit = register_face(face, samples, placement, anchors);
  for (const anatomy::Landmark& landmark : anatomy.landmarks) {
    if (!landmark.skin || all.count(landmark.name)) continue;
    const auto place = facing_point(skin, fit(*landmark.skin), carried_normal(fit, *landmark.skin, landmark.normal));
    if (!place) continue;
    const double off = place->distance / placement.scale;
    all[landmark.name] = {place->position, confidence_at(face, fit, *landmark.skin) * std::exp(-off / 0.015), false};
  }
  return all;
}

}  // namespace fascia::landmarks
