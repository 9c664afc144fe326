#include "builder/landmarks/find.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "builder/landmarks/lid_opening.h"
#include "builder/landmarks/likeness.h"
#include "builder/landmarks/lip_opening.h"
#include "builder/landmarks/nose_profile.h"

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
/// Residual of the coarse fit, metres on the generic head, beyond which it is no evidence for a position.
constexpr double far_off = 0.012;

/// Refines `placement` to a fixed point that does not depend on where near it the search ended, so that a
/// rotated, moved or remeshed head gives the same landmarks.
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
  return {outer, inner, placement.rotation * Vec3::UnitZ(), placement.rotation * Vec3::UnitY(), ball, 0.035};
}

/// One eye as the fit has it on this head.
EyeRegion fitted_eye(const GenericFace& face, const anatomy::GenericAnatomy& anatomy, const Registration& fit,
                     bool left, const std::optional<Ball>& known) {
  const std::string side = left ? "left" : "right";
  const auto generic = [&](const char* name) { return *anatomy.landmark(name + side)->skin; };
  const Ball& ball = left ? face.eye_left : face.eye_right;
  const Ball carried = known ? *known : Ball{fit(ball.centre), ball.radius * fit.placement.scale};
  return eye_region(fit(generic("exocanthion_")), fit(generic("endocanthion_")), carried, fit.placement);
}

/// The openings of both eyes' lids, where they are seen.
struct Openings {
  std::optional<LidOpening> left, right;
  bool are_far = false;  ///< from where the fit has the eyes
};

/// `eye` moved by shares of its width, outward and up, and grown about its middle.
EyeRegion moved_eye(EyeRegion eye, double outward, double upward, double growth) {
  const double width = (eye.outer - eye.inner).norm();
  const Vec3 middle = 0.5 * (eye.outer + eye.inner);
  const Vec3 way = outward * (eye.outer - eye.inner) + upward * width * eye.up;
  for (Vec3* p : {&eye.outer, &eye.inner, &eye.ball.centre})
    *p = middle + growth * (*p - middle) + way;
  eye.ball.radius *= growth;
  eye.depth = 0.25;  // a ball put somewhere may stand before closed lids
  return eye;
}

/// Whether two openings are the two eyes of one face: as wide and as high, and at one height.
bool are_a_pair(const LidOpening& a, const LidOpening& b, const Vec3& up) {
  constexpr double alike = 0.25, level = 0.2;  // of the width
  const double wide_a = (a.outer - a.inner).norm(), wide_b = (b.outer - b.inner).norm(),
               width = std::max(wide_a, wide_b), high_a = (a.upper - a.lower).norm(),
               high_b = (b.upper - b.lower).norm();
  return std::abs(wide_a - wide_b) < alike * width && std::abs(high_a - high_b) < alike * width &&
         std::abs((a.upper + a.lower - b.upper - b.lower).dot(up)) < 2.0 * level * width;
}

/// Both eyes' openings: each where the fit has the eye, or, where neither is seen there, as in faces with
/// eyes larger or lower than people's, a pair of them about there.
Openings eye_openings(const spatial::SurfaceQuery& skin, const EyeRegion& left, const EyeRegion& right,
                      bool are_known) {
  Openings seen{lid_opening(skin, left), lid_opening(skin, right)};
  if (seen.left || seen.right || are_known) return seen;
  for (const double growth : {1.0, 1.4, 1.8})
    for (const double upward : {-0.3, 0.3, -0.6})
      for (const double outward : {0.0, 0.25}) {
        seen = {lid_opening(skin, moved_eye(left, outward, upward, growth)),
                lid_opening(skin, moved_eye(right, outward, upward, growth)), true};
        if (seen.left && seen.right && are_a_pair(*seen.left, *seen.right, left.up)) return seen;
      }
  return {};
}

/// Corners and margins of the lids of one side, put where this head's lids open: the generic head's own
/// opening, looked at the same way, tells how the landmarks lie beside what is seen.
std::vector<std::pair<std::string, Vec3>> lid_landmarks(const GenericFace& face,
                                                        const anatomy::GenericAnatomy& anatomy,
                                                        const Registration& fit, bool left,
                                                        const std::optional<LidOpening>& here, bool is_far) {
  const std::string side = left ? "left" : "right";
  const auto generic = [&](const char* name) { return *anatomy.landmark(name + side)->skin; };
  const Vec3 outer = generic("exocanthion_"), inner = generic("endocanthion_");
  const auto there =
      lid_opening(spatial::SurfaceQuery(face.skin),
                  eye_region(outer, inner, left ? face.eye_left : face.eye_right, Placement{}));
  if (!here || !there) return {};
  const double scale = fit.placement.scale;
  const auto moved = [&](const Vec3& at, const Vec3& seen_here, const Vec3& seen_there) {
    return Vec3(seen_here + scale * (fit.placement.rotation * (at - seen_there)));
  };
  // A corner far from where the fit has it is a hole in the mesh or a fold, not the corner.
  const double most = is_far ? scale : 0.2 * scale * (outer - inner).norm();
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

/// The mouth's corners where this head's lips part, if that is elsewhere than where the fit has them, as in
/// drawn faces with a mouth narrower or wider than people's. Near there the fit knows better: corners are
/// flat, and where exactly the skin begins to go on is a matter of modelling.
Landmarks lip_landmarks(const GenericFace& face, const anatomy::GenericAnatomy& anatomy,
                        const Registration& fit, const spatial::SurfaceQuery& skin) {
  constexpr double known = 0.11;     // of the mouth's width: nearer to the fit, the fit stands
  constexpr double lopsided = 0.08;  // of the mouth's width: how far its middle may lie beside the fit's
  const Vec3 left = *anatomy.landmark("cheilion_left")->skin,
             right = *anatomy.landmark("cheilion_right")->skin;
  const auto there =
      lip_opening(spatial::SurfaceQuery(face.skin), SkinLinks(face.skin), {left, right, Vec3::UnitZ()});
  if (!there) return {};
  const Mat3& turn = fit.placement.rotation;
  const SkinLinks links(skin.mesh());
  Vec3 on_left = fit(left), on_right = fit(right);
  // How near to its end an opening is detected depends on the width that is searched for.
  double change = 1.0;
  for (int round = 0; round < 4; ++round) {
    const double before = (on_left - on_right).norm();
    const auto here = lip_opening(skin, links, {on_left, on_right, turn * Vec3::UnitZ()});
    if (!here) return {};
    const double scale = before / (left - right).norm();
    on_left = here->left + scale * (turn * (left - there->left));
    on_right = here->right + scale * (turn * (right - there->right));
    change = std::abs((on_left - on_right).norm() / before - 1.0);
  }
  if (change > 0.15) return {};  // folds and gaps, no opening with two ends
  const Vec3 middle = 0.5 * (on_left + on_right - fit(left) - fit(right));
  const double width = (fit(left) - fit(right)).norm();
  if (std::abs(middle.dot((fit(left) - fit(right)) / width)) > lopsided * width)
    return {};  // a hole beside it
  const double off = 0.5 * ((on_left - fit(left)).norm() + (on_right - fit(right)).norm());
  if (off < known * width) return {};
  return {{"cheilion_left", on_left}, {"cheilion_right", on_right}};
}

/// `warp` with the face higher or lower below and above the eyes, by the factor `growth`.
splines::Warp stretched(const GenericFace& face, const splines::Warp& warp, double growth) {
  constexpr double smooth = 1e-4;
  std::vector<Vec3> from, to;
  for (size_t i : some_face_points(face, 8))
    from.push_back(face.points.points[i]);
  const double eyes = warp(Vec3(0.5 * (face.eye_left.centre + face.eye_right.centre))).y();
  for (const Vec3& p : from) {
    to.push_back(warp(p));
    to.back().y() = eyes + growth * (to.back().y() - eyes);
  }
  splines::WarpOptions plate;
  plate.lambda = smooth;
  return splines::fit_warp(from, to, plate);
}

/// `fit` begun again from longer and from shorter faces while that makes it more like a face: the lips of a
/// long face are drawn to its chin's furrow or nose, those of a short one to its chin, and stay there.
Registration with_fitting_length(const GenericFace& face, const Samples& samples,
                                 const std::vector<Anchor>& anchors, const RegistrationOptions& options,
                                 Registration fit) {
  constexpr double step = 1.12, gain = 1.01;
  constexpr int rounds = 4;
  const Neighbours surface(samples);
  double score = likeness(face, fit, surface).score();
  for (const double growth : {step, 1.0 / step}) {
    bool has_changed = false;
    for (int round = 0; round < rounds; ++round) {
      Registration other =
          register_face(face, samples, fit.placement, anchors, options, stretched(face, fit.warp, growth));
      const double here = likeness(face, other, surface).score();
      if (here < gain * score) break;
      fit = std::move(other);
      score = here;
      has_changed = true;
    }
    if (has_changed) break;
  }
  return fit;
}

/// Tip and base of the nose by the profile, where `fit` shows it.
Landmarks nose_landmarks(const anatomy::GenericAnatomy& anatomy, const Registration& fit,
                         const spatial::SurfaceQuery& skin) {
  const auto fitted = [&](const char* name) { return fit(*anatomy.landmark(name)->skin); };
  const auto nose = nose_profile(
      skin, {fitted("sellion"), fitted("menton"), fit.placement.rotation.col(2), fit.placement.scale});
  if (!nose) return {};
  Landmarks places{{"pronasale", nose->tip}};
  if (nose->base) places["subnasale"] = *nose->base;
  return places;
}

/// How far `fit` has its nose from the tip seen in the profile, metres of the generic head; 0 where none was.
double off_nose(const anatomy::GenericAnatomy& anatomy, const Registration& fit, const Landmarks& nose) {
  const auto tip = nose.find("pronasale");
  if (tip == nose.end()) return 0.0;
  return (fit(*anatomy.landmark("pronasale")->skin) - tip->second).norm() / fit.placement.scale;
}

std::vector<Anchor> anchors_of(const Landmarks& points, const anatomy::GenericAnatomy& anatomy,
                               double weight) {
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

Landmarks rough_landmarks(const GenericFace& face, const anatomy::GenericAnatomy& anatomy,
                          const FoundHead& found) {
  Landmarks rough;
  for (const anatomy::Landmark& landmark : anatomy.landmarks)
    if (landmark.skin && landmark.required && overhang_at(face, found.fit, *landmark.skin) < beyond_edge &&
        residual_at(face, found.fit, *landmark.skin) < far_off)
      rough[landmark.name] = found.fit(*landmark.skin);
  return rough;
}

FoundFace find(const GenericFace& face, const anatomy::GenericAnatomy& anatomy,
               const spatial::SurfaceQuery& skin, const Placement& start, const Landmarks& given,
               const KnownEyes& eyes) {
  FoundFace found;
  Landmarks known;
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
  if (const std::vector<Anchor> of_eyes = eye_anchors(face, found.fit, eyes); !of_eyes.empty()) {
    anchors.insert(anchors.end(), of_eyes.begin(), of_eyes.end());
    found.fit = register_face(face, samples, placement, anchors, first);
  }
  found.fit = with_fitting_length(face, samples, anchors, first, std::move(found.fit));
  constexpr double seen_weight = 20.0;
  Landmarks nose;
  if (!known.count("pronasale") && !known.count("subnasale")) nose = nose_landmarks(anatomy, found.fit, skin);
  const bool has_eyes_by_hand = known.count("exocanthion_left") || known.count("exocanthion_right");
  const Openings lids =
      eye_openings(skin, fitted_eye(face, anatomy, found.fit, true, eyes.left),
                   fitted_eye(face, anatomy, found.fit, false, eyes.right), has_eyes_by_hand);
  Landmarks seen;
  for (const bool left : {true, false})
    for (const auto& [name, p] :
         lid_landmarks(face, anatomy, found.fit, left, left ? lids.left : lids.right, lids.are_far))
      if (!known.count(name)) seen[name] = p;
  const bool has_mouth_by_hand = known.count("cheilion_left") || known.count("cheilion_right");
  const Vec3 fitted_corner = found.fit(*anatomy.landmark("cheilion_left")->skin);
  const Landmarks corners = has_mouth_by_hand ? Landmarks() : lip_landmarks(face, anatomy, found.fit, skin);
  seen.insert(corners.begin(), corners.end());
  for (const Anchor& anchor : anchors_of(seen, anatomy, seen_weight))
    anchors.push_back(anchor);
  const bool are_corners_far =
      !corners.empty() && (corners.at("cheilion_left") - fitted_corner).norm() > far_off * placement.scale;
  if (lids.are_far || are_corners_far) {
    constexpr double lost = 0.006;  // metres of the generic head
    const double before = off_nose(anatomy, found.fit, nose);
    found.fit = register_face(face, samples, placement, anchors, first);
    // Eyes much lower than people's draw the nose down onto the lips with them.
    if (off_nose(anatomy, found.fit, nose) > before + lost) {
      seen.insert(nose.begin(), nose.end());
      for (const Anchor& anchor : anchors_of(nose, anatomy, seen_weight))
        anchors.push_back(anchor);
      found.fit = register_face(face, samples, placement, anchors, first);
    }
  }
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
    // Margins of lids and lips turn within a millimetre or two: what was seen there is on the surface nearest
    // to it, wherever that faces.
    const std::optional<spatial::ClosestPoint> place =
        eye != seen.end()
            ? std::optional(skin.closest(carried))
            : facing_point(skin, carried, carried_normal(found.fit, *landmark.skin, landmark.normal));
    if (!place || !place->found()) continue;
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
