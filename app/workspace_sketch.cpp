// Regions of muscles drawn on the skin.
#include "app/model/names.h"
#include "app/workspace.h"
#include "builder/spatial/mirror_plane.h"

namespace fascia::app {

std::vector<Vec3> Workspace::mirror_image(std::vector<Vec3> curve) const {
  std::vector<std::pair<Vec3, Vec3>> pairs;
  for (const rig::Landmark& left : rig->rig->skull.landmarks) {
    if (split_side(left.name).half != Half::left) continue;
    for (const rig::Landmark& right : rig->rig->skull.landmarks)
      if (right.name == mirrored(left.name))
        pairs.emplace_back(left.skin.cast<double>(), right.skin.cast<double>());
  }
  const spatial::MirrorPlane plane = spatial::plane_between(pairs).value_or(spatial::MirrorPlane());
  for (Vec3& p : curve) {
    p = plane.image(p);
    if (skin_) p = skin_->nearest_place(p).position;
  }
  return curve;
}

std::string Workspace::sketch_region(const std::string& muscle, MuscleEnd end,
                                     const std::vector<Vec3>& stroke) {
  if (!rig) return "Open a head first";
  std::vector<Vec3> curve = closed_curve(stroke);
  // A chord between two places of the mouse may run below the skin.
  if (skin_)
    for (Vec3& p : curve)
      p = skin_->nearest_place(p).position;
  const std::string fault =
      stroke.empty() ? "This curve lies beside the skin; draw it on the face" : sketch_fault(curve);
  if (!fault.empty()) {
    notify("No region for the " + std::string(name_of(end)) + " of " + full_title(muscle) + ". " + fault,
           Notice::Kind::error);
    return fault;
  }
  DocumentState next = state();
  set_muscle_sketch(next, muscle, end, curve, rig->head_to_metres);
  const std::string partner = mirrored(muscle);
  if (settings.is_symmetric && partner != muscle)
    set_muscle_sketch(next, partner, end, mirror_image(curve), rig->head_to_metres);
  commit(std::move(next), "Draw the " + std::string(name_of(end)) + " of " + full_title(muscle));
  return "";
}

void Workspace::clear_sketch(const std::string& muscle, MuscleEnd end) {
  if (!rig) return;
  DocumentState next = state();
  set_muscle_sketch(next, muscle, end, {}, rig->head_to_metres);
  if (settings.is_symmetric) set_muscle_sketch(next, mirrored(muscle), end, {}, rig->head_to_metres);
  commit(std::move(next), "Let the " + std::string(name_of(end)) + " of " + full_title(muscle) + " be found");
}

std::vector<SkinHit> Workspace::sketch_now(const std::string& muscle, MuscleEnd end) const {
  std::vector<SkinHit> points;
  if (!rig) return points;
  const std::vector<Vec3> curve = muscle_sketch(state(), muscle, end, rig->head_to_metres);
  for (size_t i = 0; i < curve.size(); ++i)
    if (const auto held = hold(muscle + " " + name_of(end) + " " + std::to_string(i), curve[i]))
      points.push_back(*held);
  return points;
}

}  // namespace fascia::app
