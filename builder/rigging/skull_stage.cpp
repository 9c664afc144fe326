#include <Eigen/Geometry>
#include <algorithm>
#include <cstdio>

#include "builder/rigging/stages.h"
#include "builder/skull/from_anatomy.h"

namespace fascia::rigging {

namespace {

/// The head's own meshes of one part, joined.
TriangleMesh part_mesh(const prepare::PreparedHead& head, prepare::Part part) {
  TriangleMesh all;
  for (const prepare::PreparedMesh& mesh : head.meshes) {
    const int base = all.vertex_count();
    std::vector<Triangle> kept;
    for (const Triangle& t : mesh.triangles)
      if (mesh.parts[static_cast<size_t>(t[0])] == part)
        kept.push_back({t[0] + base, t[1] + base, t[2] + base});
    if (kept.empty()) continue;
    all.vertices.insert(all.vertices.end(), mesh.positions.begin(), mesh.positions.end());
    all.triangles.insert(all.triangles.end(), kept.begin(), kept.end());
  }
  // Only the part's own vertices may count, the rest would pull bounds and centres away.
  TriangleMesh compact;
  std::vector<int> map(all.vertices.size(), -1);
  for (Triangle t : all.triangles) {
    for (int& corner : t) {
      int& target = map[static_cast<size_t>(corner)];
      if (target < 0) {
        target = compact.vertex_count();
        compact.vertices.push_back(all.vertices[static_cast<size_t>(corner)]);
      }
      corner = target;
    }
    compact.triangles.push_back(t);
  }
  return compact;
}

rig::Eye rig_eye(const std::optional<prepare::Eyeball>& eye) {
  rig::Eye out;
  if (!eye) return out;
  out.centre = eye->centre.cast<float>();
  out.radius = static_cast<float>(eye->radius);
  out.gaze = eye->gaze.cast<float>();
  return out;
}

std::string millimetres(double metres) {
  char text[32];
  std::snprintf(text, sizeof text, "%.1f mm", 1e3 * metres);
  return text;
}

/// Fits the skull under `skin`, to the head's own teeth as far as they stand where the skin puts the jaws:
/// those of avatars are often of another size than the face, or too far back, and would tear the bone from
/// under its landmarks.
skull::FitResult fit_with_teeth(const skull::Generic& generic, const skull::Exterior& skin,
                                const std::map<std::string, skull::TargetLandmark>& targets,
                                const skull::FitOptions& options) {
  constexpr double good = 0.0025, worse = 0.0003;  // metres, of the landmarks' root mean square
  skull::FitOptions other = options;
  skull::FitResult fit = skull::fit(generic, skin, targets, other);
  if (fit.landmark_rms <= good || (!options.teeth_upper && !options.teeth_lower)) return fit;
  other.teeth_deviation = 0.0025;
  fit = skull::fit(generic, skin, targets, other);
  if (fit.landmark_rms <= good) return fit;
  other.teeth_upper = other.teeth_lower = nullptr;
  skull::FitResult by_skin = skull::fit(generic, skin, targets, other);
  if (fit.landmark_rms <= by_skin.landmark_rms + worse) return fit;
  by_skin.warnings.push_back(
      "the head's own teeth do not stand where its skin puts the jaws (the skull's landmarks " +
      millimetres(fit.landmark_rms) + " off with them, " + millimetres(by_skin.landmark_rms) +
      " without): they move with the jaws, but the skull was fitted without them");
  return by_skin;
}

void warn_of_bad_fit(skull::FitResult& fit) {
  constexpr double bad_rms = 0.004, bad_max = 0.010;  // metres; people's heads fit to 1.5 .. 3 mm
  if (fit.landmark_rms < bad_rms && fit.landmark_max < bad_max) return;
  const auto worst = std::max_element(fit.landmarks.begin(), fit.landmarks.end(),
                                      [](const skull::FittedLandmark& a, const skull::FittedLandmark& b) {
                                        return a.confidence * a.residual < b.confidence * b.residual;
                                      });
  if (worst == fit.landmarks.end()) return;
  fit.warnings.push_back("the skull fits its landmarks badly (" + millimetres(fit.landmark_rms) +
                         " in the mean, " + millimetres(worst->residual) + " at '" + worst->name +
                         "'): check that landmark, or give --tissue-scale for a head that is no adult's");
}

}  // namespace

rig::Surface rig_surface(const TriangleMesh& mesh) {
  rig::Surface surface;
  for (const Vec3& p : mesh.vertices)
    surface.positions.push_back(p.cast<float>());
  for (const Triangle& t : mesh.triangles)
    surface.triangles.push_back(
        {static_cast<uint32_t>(t[0]), static_cast<uint32_t>(t[1]), static_cast<uint32_t>(t[2])});
  return surface;
}

skull::FitResult fit_skull(const anatomy::GenericAnatomy& anatomy, const FoundLandmarks& found,
                           double tissue_scale) {
  const prepare::PreparedHead& head = found.head;
  std::map<std::string, skull::TargetLandmark> targets;
  for (const auto& [name, landmark] : found.landmarks)
    targets[name] = {landmark.position, landmark.confidence};
  skull::FitOptions options;
  options.tissue_scale = tissue_scale;
  const skull::Generic generic = skull::from_anatomy(anatomy);
  const skull::Exterior skin = skull::exterior(head.skin);
  const TriangleMesh upper = part_mesh(head, prepare::Part::teeth_upper),
                     lower = part_mesh(head, prepare::Part::teeth_lower);
  if (!upper.empty()) options.teeth_upper = &upper;
  if (!lower.empty()) options.teeth_lower = &lower;
  skull::FitResult fit = fit_with_teeth(generic, skin, targets, options);
  // A sound jaw opens straight, also in a lopsided face.
  if (found.midplane) fit.jaw.hinge = found.midplane->normal;
  warn_of_bad_fit(fit);
  return fit;
}

rig::Skull rig_skull(const skull::FitResult& skull, const prepare::PreparedHead& head,
                     const SkinLandmarks& landmarks) {
  rig::Skull out;
  out.cranium = rig_surface(skull.cranium);
  out.mandible = rig_surface(skull.mandible);
  out.teeth_upper = rig_surface(skull.teeth_upper);
  out.teeth_lower = rig_surface(skull.teeth_lower);
  std::map<std::string, const skull::FittedLandmark*> fitted;
  for (const skull::FittedLandmark& landmark : skull.landmarks)
    fitted[landmark.name] = &landmark;
  for (const auto& [name, landmark] : landmarks) {
    rig::Landmark entry;
    entry.name = name;
    entry.skin = landmark.position.cast<float>();
    entry.bone = entry.skin;
    entry.confidence = static_cast<float>(landmark.confidence);
    if (const auto at = fitted.find(name); at != fitted.end()) {
      entry.bone = at->second->bone.cast<float>();
      entry.depth = static_cast<float>(at->second->depth);
    }
    out.landmarks.push_back(entry);
  }
  const Vec3 lateral = skull.jaw.hinge.normalized();
  const Vec3 forward = (skull.jaw.forward - skull.jaw.forward.dot(lateral) * lateral).normalized();
  out.jaw.origin = skull.jaw.origin.cast<float>();
  out.jaw.lateral = lateral.cast<float>();
  out.jaw.forward = forward.cast<float>();
  out.jaw.up = forward.cross(lateral).cast<float>();
  const anatomy::mechanics::JawMotion& motion = skull.jaw.motion;
  out.jaw.open_angle = static_cast<float>(motion.open_angle);
  out.jaw.open_glide = Vec3(0.0, -motion.open_down, motion.open_forward).cast<float>();
  out.jaw.forward_glide = static_cast<float>(motion.protrusion_forward);
  out.jaw.forward_drop = static_cast<float>(motion.protrusion_down);
  out.jaw.lateral_angle = static_cast<float>(motion.lateral_angle);
  out.jaw.lateral_glide = static_cast<float>(motion.lateral_glide);
  out.jaw.travel_time = motion.travel_time;
  out.eye_left = rig_eye(head.eye_left);
  out.eye_right = rig_eye(head.eye_right);
  return out;
}

}  // namespace fascia::rigging
