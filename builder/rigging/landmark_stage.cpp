#include <Eigen/Geometry>
#include <algorithm>
#include <chrono>
#include <optional>

#include "builder/landmarks/complete.h"
#include "builder/landmarks/find.h"
#include "builder/landmarks/symmetry.h"
#include "builder/prepare/repair.h"
#include "builder/rigging/find_landmarks.h"
#include "builder/rigging/shape_places.h"
#include "builder/rigging/stages.h"
#include "geometry/error.h"
#include "geometry/nearest_names.h"

namespace fascia::rigging {

namespace {

constexpr double given_weight = 100.0;  // of a correspondence that was found: at most 1

bool has_all_required(const formats::LandmarkFile& given, const anatomy::GenericAnatomy& anatomy) {
  for (const anatomy::Landmark& landmark : anatomy.landmarks)
    if (landmark.required && !given.points.count(landmark.name)) return false;
  return true;
}

/// The given landmarks that the anatomy knows, as places of the generic head's own.
std::vector<landmarks::Anchor> anchors_of(const formats::LandmarkFile& given,
                                          const anatomy::GenericAnatomy& anatomy) {
  std::vector<landmarks::Anchor> anchors;
  for (const auto& [name, p] : given.points) {
    const anatomy::Landmark* known = anatomy.landmark(name);
    if (!known || !known->skin) continue;
    const bool repeats = std::any_of(anchors.begin(), anchors.end(), [&](const landmarks::Anchor& a) {
      return (a.generic - *known->skin).norm() < 1e-3;
    });
    if (!repeats) anchors.push_back({*known->skin, p, given_weight});
  }
  return anchors;
}

std::optional<Vec3> declared_up(const std::string& up) {
  if (up == "y") return Vec3::UnitY();
  if (up == "z") return Vec3::UnitZ();
  return std::nullopt;
}

/// `placement` in the file's axes and units, in those that `map` (a similarity) leads to.
landmarks::Placement mapped(const landmarks::Placement& placement, const Mat4& map) {
  landmarks::Placement result;
  const double scale = map.topLeftCorner<3, 1>().norm();
  result.scale = scale * placement.scale;
  result.rotation = map.topLeftCorner<3, 3>() / scale * placement.rotation;
  result.shift = transform_point(map, placement.shift);
  return result;
}

/// The head as found in a file, before its units and axes are known.
struct LocatedHead {
  formats::LandmarkFile landmarks;  ///< given ones and, where those are missing, rough ones; file's units
  std::optional<landmarks::FoundHead> found;      ///< nothing when all required landmarks are given
  std::optional<landmarks::GenericFace> generic;  ///< with `found`
};

/// By how face-like the surfaces are; where nothing is, or only doubtfully, or where the head's own shapes
/// say that its face stands elsewhere, by those. What the caller knows (two places and more) comes first.
landmarks::FoundHead find_head(const formats::Scene& scene, const landmarks::GenericFace& generic,
                               const anatomy::GenericAnatomy& anatomy, const prepare::PrepareOptions& options,
                               const landmarks::HeadHints& hints, const ForEach& for_each) {
  const std::string path = scene.path.string();
  const auto by_surface = [&] {
    return landmarks::find_head(generic, prepare::search_surfaces(scene, options.skin), path, hints,
                                for_each);
  };
  const auto places = hints.given.size() < 2 ? places_by_shapes(scene, anatomy) : std::nullopt;
  if (!places) return by_surface();
  std::optional<landmarks::FoundHead> found;
  try {
    found = by_surface();
  } catch (const Error&) {
    // The shapes are left to tell.
  }
  if (found && !found->is_doubtful && places->agree(found->placement())) return *found;
  return landmarks::find_head(generic, prepare::joined_meshes(scene, places->mesh), path,
                              {places->anchors, hints.up}, for_each);
}

LocatedHead locate_head(const formats::Scene& scene, const formats::LandmarkFile& given,
                        const anatomy::GenericAnatomy& anatomy, const prepare::PrepareOptions& options,
                        const ForEach& for_each) {
  LocatedHead located;
  located.landmarks = given;
  if (has_all_required(given, anatomy)) return located;
  located.landmarks = prepare::in_file_units(scene, given);
  located.landmarks.units = prepare::head_units;
  located.generic = landmarks::generic_face(anatomy);
  located.found = find_head(scene, *located.generic, anatomy, options,
                            {anchors_of(located.landmarks, anatomy), declared_up(options.up)}, for_each);
  for (const auto& [name, p] : landmarks::rough_landmarks(*located.generic, anatomy, *located.found))
    located.landmarks.points.emplace(name, p);
  return located;
}

Landmarks reference_points(const anatomy::GenericAnatomy& anatomy) {
  Landmarks points;
  for (const anatomy::Landmark& landmark : anatomy.landmarks)
    if (landmark.skin) points[landmark.name] = *landmark.skin;
  return points;
}

void place_landmarks(FoundLandmarks& result, const LocatedHead& located, const formats::LandmarkFile& given,
                     const anatomy::GenericAnatomy& anatomy, bool with_regions) {
  const prepare::PreparedHead& head = result.head;
  Landmarks by_hand;
  for (const auto& [name, p] : head.landmarks)
    if (given.points.count(name)) by_hand[name] = p;
  std::vector<std::string> unknown;
  const spatial::SurfaceQuery& skin = *head.surface;
  if (located.found) {
    landmarks::KnownEyes eyes;
    if (head.eye_left) eyes.left = {head.eye_left->centre, head.eye_left->radius};
    if (head.eye_right) eyes.right = {head.eye_right->centre, head.eye_right->radius};
    const landmarks::Placement placement = mapped(located.found->placement(), head.input_to_metres);
    // Sockets that the face was found by stand for the eyeballs they have none of.
    for (const landmarks::Anchor& anchor : located.found->eyes) {
      const landmarks::Ball& generic = located.generic->eye_left;
      const landmarks::Ball ball{transform_point(head.input_to_metres, anchor.target),
                                 generic.radius * placement.scale};
      auto& eye = anchor.generic.x() > 0.0 ? eyes.left : eyes.right;
      if (!eye) eye = ball;
    }
    landmarks::FoundFace face = landmarks::find(*located.generic, anatomy, skin, placement, by_hand, eyes);
    result.landmarks = std::move(face.landmarks);
    unknown = std::move(face.unknown);
    if (with_regions) result.regions = landmarks::face_regions(*located.generic, face.fit, head.skin);
  } else {
    result.landmarks = landmarks::complete(by_hand, anatomy, skin, &unknown);
  }
  std::vector<std::string> names;
  for (const auto& [name, p] : reference_points(anatomy))
    names.push_back(name);
  for (const std::string& name : unknown)
    result.warnings.push_back("landmark '" + name + "' is not a name that is known here" +
                              did_you_mean(name, names) + "; it is left out");
}

/// The same meshes with their triangles facing the other way.
formats::Scene turned_over(formats::Scene scene) {
  for (formats::SceneMesh& mesh : scene.meshes)
    for (Triangle& t : mesh.triangles)
      std::swap(t[1], t[2]);
  return scene;
}

/// The warning about an unlikely face, with a remedy that has not been tried yet.
std::string doubt(const formats::Scene& scene, const formats::LandmarkFile& given, bool is_by_eyes) {
  const std::string found =
      "'" + scene.path.string() + "': " +
      (is_by_eyes
           ? "no face like a person's was found in it; two eyes, the symmetry about them and a nose or "
             "muzzle below were taken for one"
           : "the face found in it is unlike most faces") +
      "; look at its landmarks (fascia render RIG.glb --layers skin,landmarks) and, where they are off, ";
  if (given.points.size() < 2) return found + "give exocanthion_left and exocanthion_right with --landmarks";
  return found + "give more of them with --landmarks: " + std::to_string(given.points.size()) + " were given";
}

/// Changes the rig frame: x becomes rotation * x + translation (metres).
void move_frame(FoundLandmarks& result, const Mat3& rotation, const Vec3& translation) {
  prepare::move(result.head, rotation, translation);
  if (result.midplane)
    result.midplane = {rotation * result.midplane->point + translation, rotation * result.midplane->normal};
  for (auto& [name, landmark] : result.landmarks)
    landmark.position = rotation * landmark.position + translation;
}

/// The turn that makes the face's mirror plane the rig frame's own, for what follows tells left from right by
/// the axes: a head that leans a little would move otherwise on one side than on the other. What leans by
/// less than landmarks are found to keeps the file's axes.
Mat3 upright_turn(const landmarks::FaceMirror& mirror) {
  const double least = (mirror.is_exact ? 0.25 : 0.75) * EIGEN_PI / 180.0;
  const Mat3 turn = landmarks::upright(mirror.plane);
  return Eigen::AngleAxisd(turn).angle() < least ? Mat3::Identity() : turn;
}

/// The shift (metres) of the rig frame's origin that brings it near the face where it is far from it, as in a
/// character that stands on its origin: the runtime computes in single precision, and at 1.6 m rounding ends
/// a static pose's line search early.
Vec3 shift_to_face(const std::map<std::string, landmarks::SkinLandmark>& found, const Mat3& turn) {
  constexpr double farthest = 0.25, step = 0.125;  // metres; whole steps: coordinates keep their digits
  if (found.empty()) return Vec3::Zero();
  Vec3 centre = Vec3::Zero();
  for (const auto& [name, landmark] : found)
    centre += turn * landmark.position / static_cast<double>(found.size());
  if (centre.norm() < farthest) return Vec3::Zero();
  return -step * (centre / step).array().round().matrix();
}

/// Brings the rig frame upright and its origin near the face.
void settle_frame(FoundLandmarks& result, const Mat3& turn) {
  const Vec3 shift = shift_to_face(result.landmarks, turn);
  if (turn == Mat3::Identity() && shift.isZero(0.0)) return;
  move_frame(result, turn, shift);
}

/// Makes the eyeballs of a head that is its own mirror image each other's images too, where they nearly are:
/// a globe that is guessed behind a flat eye depends on how that is cut into triangles.
void pair_eyes(prepare::PreparedHead& head, const spatial::MirrorPlane& plane) {
  constexpr double most_apart = 0.3, most_larger = 1.2;  // of the radius; one over the other
  if (!head.eye_left || !head.eye_right) return;
  prepare::Eyeball &left = *head.eye_left, &right = *head.eye_right;
  const Vec3 image = plane.image(right.centre);
  const double ratio = left.radius / right.radius;
  if ((left.centre - image).norm() > most_apart * left.radius || std::max(ratio, 1.0 / ratio) > most_larger)
    return;
  left.centre = 0.5 * (left.centre + image);
  right.centre = plane.image(left.centre);
  left.radius = right.radius = 0.5 * (left.radius + right.radius);
}

/// The pupils lie on the globes, not on the skin: before each one's centre, as it looks, as sure as the
/// corner of the lids beside it.
void place_pupils(FoundLandmarks& result, const formats::LandmarkFile& given) {
  for (const auto& [side, eye] :
       {std::pair("left", result.head.eye_left), std::pair("right", result.head.eye_right)}) {
    const std::string name = std::string("pupilla_") + side;
    const auto corner = result.landmarks.find(std::string("endocanthion_") + side);
    if (!eye || given.points.count(name) || corner == result.landmarks.end()) continue;
    result.landmarks[name] = {eye->centre + eye->radius * eye->gaze, corner->second.confidence, false};
  }
}

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

}  // namespace

FoundLandmarks find_landmarks(const formats::Scene& file, const formats::LandmarkFile& given,
                              const anatomy::GenericAnatomy& anatomy, const prepare::PrepareOptions& options,
                              bool with_regions, const ForEach& for_each) {
  FoundLandmarks result;
  const double started = now();
  const prepare::Repaired repaired = prepare::repair(file, options.skin);
  const formats::Scene& scene = repaired.scene ? *repaired.scene : file;
  result.warnings = repaired.warnings;
  const LocatedHead located = locate_head(scene, given, anatomy, options, for_each);
  if (located.found) {
    result.likeness = located.found->likeness.score();
    result.is_inside_out = located.found->is_inside_out;
    if (result.is_inside_out)
      result.warnings.push_back(
          "the triangles of '" + scene.path.string() +
          "' face inward: they were taken as turned over; the file's own stay as they are");
    result.is_doubtful = located.found->is_doubtful;
    if (located.found->is_doubtful)
      result.warnings.push_back(doubt(scene, given, !located.found->eyes.empty()));
  }
  const double located_at = now();
  const Landmarks reference = reference_points(anatomy);
  prepare::PrepareOptions preparing = options;
  for (const auto& [name, p] : located.landmarks.points)
    if (!given.points.count(name)) preparing.rough_landmarks.insert(name);
  result.head = prepare::prepare(result.is_inside_out ? turned_over(scene) : scene, located.landmarks,
                                 reference, preparing);
  const double prepared_at = now();
  place_landmarks(result, located, given, anatomy, with_regions);
  Mat3 turn = Mat3::Identity();
  if (const auto mirror = landmarks::face_mirror(result.landmarks, *result.head.surface,
                                                 anatomy.mechanics.smas_shape.adult_width)) {
    if (mirror->is_alike) {
      landmarks::make_symmetric(*mirror, *result.head.surface, result.landmarks);
      turn = upright_turn(*mirror);
    }
    if (mirror->is_exact) pair_eyes(result.head, mirror->plane);
    result.midplane = mirror->plane;
  }
  settle_frame(result, turn);
  place_pupils(result, given);
  result.seconds = {located_at - started, prepared_at - located_at, now() - prepared_at};
  return result;
}

FoundLandmarks find_landmarks_with_edits(const formats::Scene& scene, const formats::LandmarkFile& given,
                                         const formats::LandmarkFile& edited,
                                         const anatomy::GenericAnatomy& anatomy,
                                         const prepare::PrepareOptions& options, const ForEach& for_each) {
  if (edited.points.empty()) return find_landmarks(scene, given, anatomy, options, false, for_each);
  const formats::LandmarkFile own = prepare::in_file_units(scene, edited);
  std::optional<FoundLandmarks> found;
  try {
    found = find_landmarks(scene, given, anatomy, options, false, for_each);
  } catch (const Error&) {
    // The edits are left to tell where the face is.
  }
  if (!found || found->is_doubtful) {
    formats::LandmarkFile all = prepare::in_file_units(scene, given);
    for (const auto& [name, p] : own.points)
      all.points[name] = p;
    all.units = prepare::head_units;
    return find_landmarks(scene, all, anatomy, options, false, for_each);
  }
  for (const auto& [name, p] : own.points)
    found->landmarks[name] = {transform_point(found->head.input_to_metres, p), 1.0, true};
  return std::move(*found);
}

}  // namespace fascia::rigging
