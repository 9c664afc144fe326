#include "app/workspace.h"

#include <algorithm>
#include <chrono>
#include <cmath>

#include "anatomy/anatomy.h"
#include "formats/files.h"
#include "formats/scene.h"
#include "geometry/error.h"

namespace fascia::app {

namespace {

constexpr double rebuild_delay = 0.6;   ///< seconds after the last edit
constexpr double autosave_delay = 1.0;  ///< seconds
constexpr double notice_seconds = 6.0;
constexpr double degree = EIGEN_PI / 180.0;

TriangleMesh skin_at_rest(const FaceAsset& asset) {
  TriangleMesh mesh;
  for (const FacePart& part : asset.parts) {
    if (part.part != "skin") continue;
    const int first = mesh.vertex_count();
    for (size_t i = 0; i + 2 < part.rest.size(); i += 3)
      mesh.vertices.emplace_back(part.rest[i], part.rest[i + 1], part.rest[i + 2]);
    for (Triangle t : part.triangles) {
      for (int& corner : t)
        corner += first;
      mesh.triangles.push_back(t);
    }
  }
  return mesh;
}

}  // namespace

Bounds face_box(const rig::Rig& rig) {
  std::vector<Vec3> points;
  for (const rig::Landmark& landmark : rig.skull.landmarks)
    points.push_back(landmark.skin.cast<double>());
  for (const rig::Surface* bone : {&rig.skull.cranium, &rig.skull.mandible})
    for (const rig::Vec3f& p : bone->positions)
      points.push_back(p.cast<double>());
  if (points.empty()) return {Vec3::Constant(-0.1), Vec3::Constant(0.1)};
  return bounds(points);
}

Workspace::Workspace(Places places, Simulation::Pace pace)
    : settings(read_settings(places.state / "view.json")),
      places_(std::move(places)),
      pace_(pace),
      session_(places_.state) {}

Workspace::~Workspace() {
  write_settings(places_.state / "view.json", settings);
}

void Workspace::notify(const std::string& text, Notice::Kind kind) {
  const size_t most = 5;
  if (!notices.empty() && notices.back().text == text) notices.pop_back();
  notices.push_back({text, kind, 0.0});
  if (notices.size() > most) notices.erase(notices.begin());
}

// --- What comes back from threads

void Workspace::adopt(LoadedRig loaded) {
  std::unique_ptr<Simulation> next = std::make_unique<Simulation>(loaded.asset, FASCIA_SOLVER_OWN, pace_);
  const bool is_other_head = !opened_.empty();
  if (is_other_head) {
    orbit.frame(face_box(*loaded.rig));
    before_.reset();
    selected_landmark.clear();
    selected_muscle.clear();
    hidden_muscles.clear();
    if (state().head != opened_) {
      DocumentState first = state();
      first.head = opened_;
      first.pose.clear();
      first.edits = nlohmann::ordered_json::object();
      history_.reset(std::move(first));
    }
    settings.remember(opened_);
  } else {
    before_ = std::move(rig);
  }
  built_edits_ = building_edits_;
  rig = std::move(loaded);
  part_with(std::exchange(simulation, std::move(next)));
  part_with(std::move(live_skull_));
  skull_shift.reset();
  if (std::exchange(restores_, false)) {
    session_.keep(state());
    session_.forget_left_behind();
  }
  frame = rest_frame_ = simulation->frame();
  poke_.reset();
  holds_.clear();
  skin_.reset();
  TriangleMesh skin = skin_at_rest(*rig->asset);
  if (!skin.empty()) skin_.emplace(std::move(skin));
  warnings.clear();
  if (rig->report)
    for (const std::string& text : rig->report->warnings)
      warnings.push_back(warning_of(text));
  compare_with(is_other_head ? Reference::none : comparison.reference, comparison.file);
  remove_old_builds();
  ++changes_;
}

void Workspace::take_build() {
  given_up_.erase(std::remove_if(given_up_.begin(), given_up_.end(),
                                 [](const auto& task) { return task->progress().is_done; }),
                  given_up_.end());
  if (!build_ || !build_->progress().is_done) return;
  const std::unique_ptr<BuildTask> done = std::move(build_);
  std::optional<LoadedRig> result = done->take_result();
  if (!result) {
    failed_edits_ = building_edits_;
    if (!done->fault().empty()) notify(done->fault(), Notice::Kind::error);
    return;
  }
  try {
    const bool is_rebuilt = opened_.empty();
    adopt(std::move(*result));
    if (rig->report) {
      double seconds = 0.0;
      for (const rigging::StageTime& stage : rig->report->stages)
        seconds += stage.seconds;
      char text[96];
      std::snprintf(text, sizeof text, "%s in %.1f s, %zu muscles", is_rebuilt ? "Rebuilt" : "Built", seconds,
                    rig->rig->muscles.size());
      notify(text);
    }
  } catch (const std::exception& error) {
    notify(error.what(), Notice::Kind::error);
  }
  opened_.clear();
}

Warning Workspace::warning_of(const std::string& text) const {
  Warning warning{text, "", std::nullopt};
  size_t longest = 0;
  for (const rig::Landmark& landmark : rig->rig->skull.landmarks)
    if (landmark.name.size() > longest && text.find(landmark.name) != std::string::npos) {
      longest = landmark.name.size();
      warning.landmark = landmark.name;
      warning.place = landmark.skin.cast<double>();
    }
  if (warning.place) return warning;
  for (const rig::Muscle& muscle : rig->rig->muscles)
    if (muscle.name.size() > longest && !muscle.points.empty() &&
        text.find(muscle.name) != std::string::npos) {
      longest = muscle.name.size();
      warning.place = muscle.points[muscle.points.size() / 2].cast<double>();
    }
  if (warning.place) return warning;
  // Rows of the check name an opening and a side.
  const bool is_right = text.find("_right") != std::string::npos;
  for (const auto& [word, landmark] : {std::pair("lid", "exocanthion"),
                                       {"blink", "exocanthion"},
                                       {"cornea", "exocanthion"},
                                       {"lip", "stomion"},
                                       {"mouth", "stomion"},
                                       {"jaw", "gnathion"},
                                       {"teeth", "stomion"},
                                       {"nose", "pronasale"}})
    if (text.find(word) != std::string::npos)
      for (const rig::Landmark& known : rig->rig->skull.landmarks)
        if (known.name == landmark || known.name == landmark + std::string(is_right ? "_right" : "_left")) {
          warning.landmark = known.name;
          warning.place = known.skin.cast<double>();
          return warning;
        }
  return warning;
}

// --- Time

void Workspace::submit(double seconds) {
  FaceInputs inputs;
  inputs.pose = state().pose;
  if (live) inputs.live = live->values();
  if (take) {
    const TakeChoice& choice = state().take;
    if (!choice.is_muted) inputs.takes.push_back({take, choice.weight});
    for (size_t i = 0; i < choice.layers.size(); ++i)
      if (const auto layer = layer_take(i); layer && !choice.layers[i].is_muted)
        inputs.takes.push_back({layer, choice.layers[i].weight});
    inputs.take_time = playback.time;
  }
  const float g = 9.81F;
  // At rest the face hangs as it was scanned, upright: what it feels lying down is the difference to that.
  if (gravity == Gravity::lying) inputs.acceleration = {0.0F, g, -g};
  if (gravity == Gravity::face_down) inputs.acceleration = {0.0F, g, g};
  if (gravity == Gravity::upside_down) inputs.acceleration = {0.0F, 2.0F * g, 0.0F};
  const double yaw = shake_yaw() * degree;
  inputs.head(0, 0) = inputs.head(2, 2) = static_cast<float>(std::cos(yaw));
  inputs.head(0, 2) = static_cast<float>(std::sin(yaw));
  inputs.head(2, 0) = -inputs.head(0, 2);
  if (poke_ && frame && poke_->part < frame->positions.size()) {
    const std::vector<float>& flat = frame->positions[poke_->part];
    const Vec3 now =
        Eigen::Map<const Eigen::Vector3f>(flat.data() + 3 * size_t{poke_->vertex}).cast<double>();
    const double newtons_a_metre = 150.0, strongest = 4.0;
    Vec3 force = newtons_a_metre * (poke_->target - now);
    if (force.norm() > strongest) force *= strongest / force.norm();
    double sum = 0.0;
    for (const auto& [vertex, share] : poke_->grip)
      sum += share;
    for (const auto& [vertex, share] : poke_->grip)
      inputs.touches.push_back({poke_->part, vertex, (share / sum * force).cast<float>()});
  }
  inputs.wants_compression = settings.layers.strain;
  inputs.wants_nodes = settings.layers.fat || settings.layers.lattice || settings.layers.smas;
  inputs.resets = resets_;
  (void)seconds;
  simulation->submit(inputs);
  if (reference) reference->submit(inputs);
}

double Workspace::shake_yaw() const {
  if (!shake_) return 0.0;
  const double length = 1.2, widest = 14.0, turns = 3.0;  // seconds, degrees, to and fro
  if (*shake_ >= length) return 0.0;
  const double fade = std::sin(EIGEN_PI * *shake_ / length);
  return widest * fade * std::sin(2.0 * EIGEN_PI * turns * *shake_ / length);
}

/// The skull under landmarks that have been moved, until it is built again.
void Workspace::follow_landmarks() {
  if (!rig) return;
  const bool shows_landmarks = settings.layers.landmarks || settings.panel == "landmarks";
  if (!live_skull_ && shows_landmarks)
    live_skull_ = std::make_unique<LiveSkull>(
        rig->rig, [asset = rig->asset] { return head_meshes(*asset); },
        waits() ? LiveSkull::Pace::at_once : LiveSkull::Pace::background);
  if (!live_skull_) return;
  Landmarks moved;
  if (has_unbuilt_edits())
    for (const std::string& name : edited_landmarks(state()))
      if (const auto place = landmark(name)) moved[name] = *place;
  live_skull_->submit(moved);
  const auto shift = moved.empty() ? nullptr : live_skull_->shift();
  if (shift != skull_shift) ++changes_;
  skull_shift = shift;
}

void Workspace::update(double seconds) {
  take_build();
  take_jobs();
  take_other();
  take_files(waits());
  take_saved(waits());
  for (Notice& notice : notices)
    notice.age += seconds;
  notices.erase(std::remove_if(notices.begin(), notices.end(),
                               [](const Notice& notice) {
                                 return notice.age >
                                        (notice.kind == Notice::Kind::error ? 3.0 : 1.0) * notice_seconds;
                               }),
                notices.end());
  since_edit_ += seconds;
  since_save_ += seconds;
  if (since_save_ > autosave_delay && !state().head.empty()) {
    session_.keep(state());
    since_save_ = 0.0;
  }
  if (rebuilds_by_itself && has_unbuilt_edits() && !is_building() && since_edit_ > rebuild_delay &&
      state().edits != failed_edits_)
    rebuild();
  if (take && playback.is_playing) {
    const TakeChoice& choice = state().take;
    const double end = timeline_end();
    playback.time += seconds;
    if (playback.time > end) {
      const double length = end - choice.begin;
      if (choice.loops && length > 1e-3 && !playback.is_recording) {
        playback.time = choice.begin + std::fmod(playback.time - choice.begin, length);
      } else {
        playback.time = end;
        playback.is_playing = false;
      }
    }
  }
  if (playback.is_recording) {
    playback.recorded_seconds += seconds;
    while (static_cast<double>(playback.recorded.size()) <= playback.recorded_seconds * recorded_rate)
      playback.recorded.push_back(state().pose);
    // Over a recording it ends with that.
    if (playback.adds_layer && !playback.is_playing) stop_recording();
  }
  if (shake_ && (*shake_ += seconds) > 1.2) shake_.reset();
  if (!simulation) return;
  take_reference(waits());
  follow_landmarks();
  submit(seconds);
  frame = simulation->frame();
  renew_reference_frame();
  const std::string fault = simulation->take_fault();
  if (!fault.empty()) notify(fault, Notice::Kind::error);
}

bool Workspace::is_busy() const {
  if (build_ || shake_ || playback.is_playing || playback.is_recording) return true;
  if (other_build_ || !coming_files_.empty() || saving_.is_running() || coming_reference_.is_running() ||
      coming_positions_.is_running())
    return true;
  for (const auto& job : jobs_)
    if (!job->is_done()) return true;
  return rebuilds_by_itself && has_unbuilt_edits() && state().edits != failed_edits_;
}

bool Workspace::is_idle() const {
  return !is_busy() && (!simulation || !simulation->is_moving()) && (!reference || !reference->is_moving());
}

uint64_t Workspace::picture_stamp() const {
  return changes_ + (frame ? frame->number : 0) + (reference_frame ? reference_frame->number : 0);
}

}  // namespace fascia::app
