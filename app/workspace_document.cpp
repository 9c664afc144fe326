#include <Eigen/LU>
#include <cmath>

#include "app/model/names.h"
#include "app/workspace.h"

namespace fascia::app {

void Workspace::commit(DocumentState next, const std::string& label, const std::string& gesture) {
  if (next.edits != state().edits) since_edit_ = 0.0;
  history_.commit(std::move(next), label, gesture);
  ++changes_;
}

void Workspace::seal() {
  history_.seal();
}

void Workspace::undo() {
  const std::string label = history_.undo_label();
  if (history_.undo()) notify("Undone: " + label);
  follow_document();
  since_edit_ = 0.0;
  ++changes_;
}

void Workspace::redo() {
  const std::string label = history_.redo_label();
  if (history_.redo()) notify("Done again: " + label);
  follow_document();
  since_edit_ = 0.0;
  ++changes_;
}

double Workspace::value(const std::string& name) const {
  const auto found = state().pose.find(name);
  if (found != state().pose.end()) return found->second;
  return rig ? static_cast<double>(rig->asset->range_of(name).rest) : 0.0;
}

void Workspace::set_value(const std::string& name, double value, bool is_gesture) {
  if (!rig || !std::isfinite(value)) return;
  DocumentState next = state();
  const FaceChannel range = rig->asset->range_of(name);
  const double clamped =
      std::clamp(value, static_cast<double>(range.minimum), static_cast<double>(range.maximum));
  set_pose(next, name, clamped, static_cast<double>(range.rest));
  const std::string partner = mirrored(name);
  if (settings.is_symmetric && partner != name) {
    // Both eyes look the same way: to the left is no mirror image.
    set_pose(next, partner, clamped, static_cast<double>(rig->asset->range_of(partner).rest));
  }
  commit(std::move(next), full_title(name), is_gesture ? "value " + name : "");
}

void Workspace::clear_pose() {
  DocumentState next = state();
  next.pose.clear();
  commit(std::move(next), "Neutral face");
}

std::optional<Vec3> Workspace::landmark(const std::string& name) const {
  if (!rig) return std::nullopt;
  if (const auto edited = landmark_edit(state(), name))
    return transform_point(edits_to_metres(state(), rig->head_to_metres), *edited);
  for (const rig::Landmark& known : rig->rig->skull.landmarks)
    if (known.name == name) return known.skin.cast<double>();
  return std::nullopt;
}

std::optional<SkinHit> Workspace::landmark_hold(const std::string& name) const {
  const auto rest = landmark(name);
  return rest ? hold(name, *rest) : std::nullopt;
}

std::optional<SkinHit> Workspace::hold(const std::string& name, const Vec3& rest) const {
  if (!rig || !frame) return std::nullopt;
  const auto [entry, is_new] = holds_.try_emplace(name);
  SkinHit& held = entry->second;
  if (is_new || held.rest != rest) {
    held = nearest_skin(*rig->asset, *frame, rest);
    held.rest = rest;
  }
  SkinHit now = held;
  const double too_far = 0.03;  // metres: a landmark off the skin moves with nothing
  if (held.part >= frame->positions.size() || held.distance > too_far) {
    now.position = rest;
    return now;
  }
  const auto at = [&](const std::vector<float>& flat) {
    return Vec3(Eigen::Map<const Eigen::Vector3f>(flat.data() + 3 * size_t{held.vertex}).cast<double>());
  };
  now.position = rest + (at(frame->positions[held.part]) - at(rig->asset->parts[held.part].rest));
  now.normal = at(frame->normals[held.part]);
  return now;
}

std::optional<Vec3> Workspace::landmark_now(const std::string& name) const {
  const auto held = landmark_hold(name);
  return held ? std::optional<Vec3>(held->position) : std::nullopt;
}

void Workspace::move_landmark(const std::string& name, const Vec3& point, bool is_gesture) {
  if (!rig) return;
  const Mat4 to_head = edits_to_metres(state(), rig->head_to_metres).inverse();
  const auto before = landmark(name);
  DocumentState next = state();
  set_landmark(next, name, transform_point(to_head, point));
  const std::string partner = mirrored(name);
  const auto opposite = landmark(partner);
  if (settings.is_symmetric && partner != name && before && opposite) {
    const Vec3 shift = point - *before;
    Vec3 image = *opposite + Vec3(-shift[0], shift[1], shift[2]);
    if (skin_) image = skin_->nearest_place(image).position;
    set_landmark(next, partner, transform_point(to_head, image));
  }
  selected_landmark = name;
  commit(std::move(next), "Move " + full_title(name), is_gesture ? "landmark " + name : "");
}

void Workspace::release_landmark(const std::string& name) {
  DocumentState next = state();
  clear_landmark(next, name);
  if (settings.is_symmetric) clear_landmark(next, mirrored(name));
  commit(std::move(next), "Let " + full_title(name) + " be found");
}

void Workspace::look_at(const Vec3& point) {
  const double near = 0.35;  // metres: a region of the face fills the viewport
  Vec3 normal = Vec3::Zero();
  if (rig && frame) normal = nearest_skin(*rig->asset, *frame, point).normal;
  orbit.look_at(point, normal, near);
}

}  // namespace fascia::app
