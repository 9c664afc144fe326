#include "builder/landmarks/find.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "builder/landmarks/lid_opening.h"

namespace fascia::landmarks {

namespace {

/// Open samples about the head: dense over the face, sparse elsewhere.
Samples head_samples(const GenericFace& face, const spatial::SurfaceQuery& skin, const Placement& placement,
                     int face_count, int head_count) {
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

constexpr double confidence_of_openings = 0.9;
/// Metres of the generic head from the surface at which a coarse fit tells nothing of a place.
constexpr double far_off = 0.012;

/// Where the generic head comes to stand whatever placement near it the search ended with: a head that is
/// turned, moved or made of other triangles gives the same landmarks.
Placement settled(const GenericFace& face, const Samples& samples, Placement placement,
                  const std::vector<Anchor>& anchors) {
  RegistrationOptions supple;  // a stiffer fit slides along chin and lips
  supple.stages = {{10, 3, 1}, {3, 3, 1}, {1, 3, 2}, {0.3, 3, 2}};
  supple.last_reach = 0.012;
  for (int round = 0; round < 2; ++round)
    placement = similarity_of(face, register_face(face, samples, placement, anchors, supple));
  return placement;
}

/// Eyeballs that lie beside where the fit has the eyes, as in large-eyed faces, draw these over: across and
/// up, for how deep a ball lies in its socket is a matter of modelling.
std::vector<Anchor> eye_anchors(const GenericFace& face, const Registration& fit, const KnownEyes& eyes) {
  const double least = 0.004;
  std::vector<Anchor> anchors;
  for (const auto& [known, generic] :
       {std::pair(eyes.left, face.eye_left), std::pair(eyes.right, face.eye_right)}) {
    if (!known) continue;
    const Vec3 carried = fit(generic.centre), deep = fit.placement.rotation.col(2);
    const Vec3 off = known->centre - carried, beside = off - off.dot(deep) * deep;
    if (beside.norm() > least * fit.placement.scale)
      anchors.push_back({generic.centre, carried + beside, 5.0});
  }
  return anchors;
}

/// An eye of a head by its corners' places; `up` and `forward` are the head's.
EyeRegion eye_region(const Vec3& outer, const Vec3& inner, const Ball& ball, const Placement& placement) {
  return {outer, inner, placement.rotation * Vec3::UnitZ(), placement.rotation * Vec3::UnitY(), ball};
}

/// Corners and margins of the lids of one side, put where this head's lids open: the generic head's own
/// opening, looked at the same way, tells how the landmarks lie beside what is seen.
std::vector<std::pair<std::string, Vec3>> lid_landmarks(const GenericFace& face,
                                                        const anatomy::GenericAnatomy& anatomy,
                                                        const spatial::SurfaceQuery& skin,
                                                        const Registration& fit, const std::string& side,
                                                        const std::optional<Ball>& known) {
  const auto generic = [&](const char* name) { return *anatomy.landmark(name + side)->skin; };
  const Vec3 outer = generic("exocanthion_"), inner = generic("endocanthion_");
  const Ball& ball = side == "left" ? face.eye_left : face.eye_right;
  const double scale = fit.placement.scale;
  const Ball carried = known ? *known : Ball{fit(ball.centre), ball.radius * scale};
  const auto here = lid_opening(skin, eye_region(fit(outer), fit(inner), carried, fit.placement));
  const auto there =
      lid_opening(spatial::SurfaceQuery(face.skin), eye_region(outer, inner, ball, Placement{}));
  if (!here || !there) return {};
  const auto moved = [&](const Vec3& at, const Vec3& seen_here, const Vec3& seen_there) {
    return Vec3(seen_here + scale * (fit.placement.rotation * (at - seen_there)));
  };
  // A corner far from where the fit has it is a hole in the mesh or a fold, not the corner.
  const double most = 0.2 * scale * (outer - inner).norm();
  std::vector<std::pair<std::string, Vec3>> found;
  const auto add = [&](const std::string& name, const Vec3& seen_here, const Vec3& seen_there) {
    const Vec3& at = *anatomy.landmark(name + side)->skin;
    const Vec3 place = moved(at, seen_here, seen_there);
    if ((place - fit(at)).norm() < most) found.push_back({name + side, place});
  };
  add("exocanthion_", here->outer, there->outer);
  add("endocanthion_", here->inner, there->inner);
  add("palpebrale_superius_", here->upper, there->upper);
  add("palpebrale_inferius_", here->lower, there->lower);
  return found;
}

/// A nose much longer than the generic one ends before the fit has its tip: what stands out farthest is
/// sought, step by step along the middle of the face. Nothing where that is where the fit has it.
std::optional<Anchor> nose_anchor(const GenericFace& face, const Registration& fit, const Samples& samples) {
  const double step = 0.012 * fit.placement.scale, aside = 0.008 * fit.placement.scale,
               least = 0.004 * fit.placement.scale;
  const Vec3 across = fit.placement.rotation.col(0), forward = fit.placement.rotation.col(2),
             start = fit(face.nose_tip);
  Vec3 tip = start;
  for (int round = 0; round < 3; ++round) {
    const Vec3 from = tip;
    for (size_t i = 0; i < samples.size(); ++i) {
      const Vec3& p = samples.points[i];
      const bool is_near =
          (p - from).squaredNorm() < step * step && std::abs((p - start).dot(across)) < aside;
      if (is_near && (p - tip).dot(forward) > 0.0) tip = p;
    }
  }
  if ((tip - start).dot(forward) < least) return std::nullopt;
  return Anchor{face.nose_tip, tip, 20.0};
}

std::vector<Anchor> anchors_of(const std::map<std::string, Vec3>& points,
                               const anatomy::GenericAnatomy& anatomy, double weight) {
  std::vector<Anchor> anchors;
  for (const auto& [name, p] : points) {
    const Vec3& generic = *anatomy.landmark(name)->skin;
    const bool repeats = std::any_of(anchors.begin(), anchors.end(),
                                     [&](const Anchor& a) { return (a.generic - generic).norm() < 1e-3; });
    if (!repeats) anchors.push_back({generic, p, weight});
  }
  return anchors;
}

}  // namespace

std::map<std::string, Vec3> rough_landmarks(const GenericFace& face, const anatomy::GenericAnatomy& anatomy,
                                            const FoundHead& found) {
  std::map<std::string, Vec3> rough;
  for (const anatomy::Landmark& landmark : anatomy.landmarks)
    if (landmark.skin && landmark.required && overhang_at(face, found.fit, *landmark.skin) < beyond_edge &&
        residual_at(face, found.fit, *landmark.skin) < far_off)
      rough[landmark.name] = found.fit(*landmark.skin);
  return rough;
}

FoundFace find(const GenericFace& face, const anatomy::GenericAnatomy& anatomy,
               const spatial::SurfaceQuery& skin, const Placement& start,
               const std::map<std::string, Vec3>& given, const KnownEyes& eyes) {
  FoundFace found;
  std::map<std::string, Vec3> known;
  for (const auto& [name, p] : given) {
    const anatomy::Landmark* landmark = anatomy.landmark(name);
    if (landmark && landmark->skin)
      known[name] = p;
    else
      found.unknown.push_back(name);
  }
  std::vector<Anchor> anchors = anchors_of(known, anatomy, 100.0);
  const Samples samples = head_samples(face, skin, start, 12000, 5000);
  const Placement placement = settled(face, samples, start, anchors);
  RegistrationOptions first;
  first.stages = {{10, 4, 1}, {3, 4, 1}, {1, 3, 2}, {0.3, 3, 2}, {0.1, 2, 2}};
  first.last_reach = 0.012;
  found.fit = register_face(face, samples, placement, anchors, first);
  std::vector<Anchor> drawn = eye_anchors(face, found.fit, eyes);
  if (!known.count("pronasale"))
    if (const std::optional<Anchor> nose = nose_anchor(face, found.fit, samples)) drawn.push_back(*nose);
  if (!drawn.empty()) {
    anchors.insert(anchors.end(), drawn.begin(), drawn.end());
    found.fit = register_face(face, samples, placement, anchors, first);
  }
  std::map<std::string, Vec3> seen;
  for (const auto& [side, ball] : {std::pair("left", eyes.left), std::pair("right", eyes.right)})
    for (const auto& [name, p] : lid_landmarks(face, anatomy, skin, found.fit, side, ball))
      if (!known.count(name)) seen[name] = p;
  for (const Anchor& anchor : anchors_of(seen, anatomy, 20.0))
    anchors.push_back(anchor);
  RegistrationOptions second;
  second.stages = {{0.03, 2, 1}, {0.01, 1, 1}, {0.004, 1, 1}};
  second.reach = 0.01;
  found.fit = register_face(face, samples, placement, anchors, second, found.fit.warp);
  for (const anatomy::Landmark& landmark : anatomy.landmarks) {
    if (!landmark.skin) continue;
    if (const auto at = known.find(landmark.name); at != known.end()) {
      found.landmarks[landmark.name] = {at->second, 1.0, true};
      continue;
    }
    const auto eye = seen.find(landmark.name);
    const Vec3 carried = eye != seen.end() ? eye->second : found.fit(*landmark.skin);
    const auto place =
        facing_point(skin, carried, carried_normal(found.fit, *landmark.skin, landmark.normal));
    if (!place) continue;
    const double distance = place->distance / placement.scale;
    const double off = std::exp(-distance / 0.015);
    const double confidence = std::max(eye != seen.end() ? confidence_of_openings : 0.0,
                                       confidence_at(face, found.fit, *landmark.skin));
    // A face alone has no ears: such a landmark stays where the bent head has it, beside the mesh.
    found.landmarks[landmark.name] = {distance < beyond_edge ? place->position : carried, off * confidence,
                                      false};
  }
  return found;
}

}  // namespace fascia::landmarks
