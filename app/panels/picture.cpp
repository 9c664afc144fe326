#include <cstdio>
#include <utility>

#include "app/panels/screen.h"
#include "app/window/theme.h"

namespace fascia::app {

namespace {

/// What the picture depends on besides the frame: drawn anew when it changes.
std::string key_of(const Workspace& work, const Area& area, const view::Camera& camera) {
  const Layers& l = work.settings.layers;
  char text[400];
  std::snprintf(
      text, sizeof text, "%g %g %.6f %.6f %.6f %.6f %.6f %.6f %d%d%d%d%d%d%d%d %.3f %d%d%d %.2f %d %llu %s ",
      static_cast<double>(area.width), static_cast<double>(area.height), camera.target[0], camera.target[1],
      camera.target[2], camera.distance, camera.yaw, camera.pitch, l.skin, l.fat, l.muscles, l.ligaments,
      l.lattice, l.smas, l.skull, l.strain, l.has_textures ? l.skin_opacity : -l.skin_opacity,
      static_cast<int>(work.comparison.reference), work.comparison.has_heat, work.comparison.is_side_by_side,
      work.comparison.scale_mm, work.settings.is_light, static_cast<unsigned long long>(work.picture_stamp()),
      work.selected_muscle.c_str());
  std::string key = text;
  for (const std::string& name : work.hidden_muscles)
    key += name + ",";
  return key;
}

/// The quality at which the window itself draws; pictures that take longer than a tenth of a second are left
/// to the thread for stills.
FacePicture::Care care_for(const Screen& screen, bool has_changed) {
  using Care = FacePicture::Care;
  if (screen.wants_full) return Care::full;
  const double fluid = 30.0, tolerable = 80.0, software = 8.0;  // milliseconds
  const auto costs = [&](Care care) { return screen.picture.milliseconds(care); };
  const double limit = has_changed ? fluid : tolerable;
  // The duration of an untried quality is unknown; if a quick picture was slow, higher ones are not tried.
  const bool is_slow = costs(Care::quick) > software;
  if (costs(Care::full) > 0.0 ? costs(Care::full) < limit : !has_changed && !is_slow) return Care::full;
  if (costs(Care::good) > 0.0 && costs(Care::good) < limit) return Care::good;
  return Care::quick;
}

view::Look look_of(const Workspace& work) {
  view::Look look;
  const ImVec4& v = palette().viewport;
  look.background = {static_cast<uint8_t>(v.x * 255.0F), static_cast<uint8_t>(v.y * 255.0F),
                     static_cast<uint8_t>(v.z * 255.0F)};
  look.has_backdrop = true;
  (void)work;
  return look;
}

/// What a picture shows: one list, or that of the reference for its left half and that of the face for its
/// right.
struct Pictured {
  view::DrawList face, reference;
  bool is_divided = false;
};

SceneOptions options_of(const Workspace& work, bool is_careful) {
  SceneOptions options;
  options.layers = work.settings.layers;
  options.has_round_fibres = is_careful;
  options.selected_muscle = work.selected_muscle;
  options.hidden_muscles = work.hidden_muscles;
  options.scale = 1e-3 * work.comparison.scale_mm;
  return options;
}

Pictured pictured(Workspace& work, Screen& screen, bool is_careful) {
  screen.face.renew(&*work.rig);
  screen.reference.renew(work.is_divided() ? work.reference_rig() : nullptr);
  SceneOptions options = options_of(work, is_careful);
  std::vector<std::vector<float>> distances;
  if (work.has_distances()) {
    distances = distances_between(*work.frame, work.reference_frame->positions);
    options.distances = &distances;
  }
  options.skull_shift = work.skull_shift.get();
  Pictured result;
  result.face = screen.face.scene->list(*work.frame, options);
  // Hairs finer than a pixel would be dots; the renderer leaves them out of its own copy of the list.
  if (!is_careful)
    std::erase_if(result.face.surfaces, [](const view::DrawSurface& surface) { return surface.is_fine; });
  result.is_divided = screen.reference.scene != nullptr;
  if (!result.is_divided) return result;
  SceneOptions other = options_of(work, is_careful);
  // A scan or a sculpt has no anatomy.
  if (work.comparison.reference == Reference::file) other.layers = Layers();
  result.reference = screen.reference.scene->list(*work.reference_frame, other);
  return result;
}

/// The camera of the reference when the face is seen by `camera`.
view::Camera beside(const Workspace& work, const view::Camera& camera) {
  view::Camera other = work.reference_camera();
  other.yaw = camera.yaw;
  return other;
}

/// Orders the picture with everything, and shows it when it comes and is still wanted.
void renew_still(Workspace& work, Screen& screen, const std::string& key, const view::Camera& camera) {
  const double calm = 0.15;  // seconds
  if (!screen.stills.works() || screen.is_scripted || screen.drawn_care == FacePicture::Care::full) return;
  if (const auto still = screen.stills.take(); still && still->key == key) {
    screen.picture.show(still->image);
    screen.drawn_care = FacePicture::Care::full;
    return;
  }
  if (screen.since_motion < calm || screen.stills.ordered() == key) return;
  Pictured shown = pictured(work, screen, true);
  StillRenderer::Order order{key, {}, look_of(work), screen.picture.width(), screen.picture.height()};
  if (shown.is_divided) order.shots.push_back({std::move(shown.reference), beside(work, camera)});
  order.shots.push_back({std::move(shown.face), camera});
  screen.stills.order(std::move(order));
}

}  // namespace

void ShownFace::renew(const LoadedRig* loaded) {
  if (asset == (loaded ? loaded->asset : nullptr)) return;
  scene.reset();
  asset = loaded ? loaded->asset : nullptr;
  rig = loaded ? loaded->rig : nullptr;
  appearance = loaded ? loaded->appearance : nullptr;
  if (asset) scene = std::make_unique<SceneStore>(*asset, *rig, appearance.get());
}

void renew_picture(Workspace& work, Screen& screen, const Area& area) {
  view::Camera camera = work.orbit.camera();
  camera.yaw -= work.shake_yaw();
  const std::string key = key_of(work, area, camera);
  const bool has_changed = key != screen.picture_key;
  screen.since_motion =
      has_changed ? 0.0 : screen.since_motion + static_cast<double>(ImGui::GetIO().DeltaTime);
  const FacePicture::Care care = care_for(screen, has_changed);
  const double calm = 0.12;  // seconds without motion before a still picture is drawn with care
  const bool is_better = care > screen.drawn_care && (screen.since_motion > calm || screen.wants_full);
  if (screen.is_scripted ? !screen.wants_full : !has_changed && !is_better)
    return renew_still(work, screen, key, camera);
  const ImVec2 pixels = ImGui::GetIO().DisplayFramebufferScale;
  const int width = static_cast<int>(area.width * pixels.x);
  screen.picture.resize(width, static_cast<int>(area.height * pixels.y));
  if (!screen.is_scripted && screen.picture.warm_up()) return;
  const Pictured shown = pictured(work, screen, care == FacePicture::Care::full);
  if (shown.is_divided) {
    screen.picture.draw(shown.reference, beside(work, camera), look_of(work), care, 0, width / 2);
    screen.picture.draw(shown.face, camera, look_of(work), care, width / 2, width - width / 2);
  } else {
    screen.picture.draw(shown.face, camera, look_of(work), care, 0, width);
  }
  screen.drawn_care = care;
  screen.picture_key = key;
  screen.wants_full = false;
}

}  // namespace fascia::app
