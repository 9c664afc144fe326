#define GLFW_INCLUDE_NONE  // epoxy has OpenGL
#include <GLFW/glfw3.h>

#include <algorithm>

#include "app/panels/screen.h"

namespace fascia::app {

namespace {

void act_on_views(Workspace& work, Screen& screen) {
  const char* const views[] = {"front", "left", "right", "three-quarter", "below"};
  for (int i = 0; i < 5; ++i)
    if (ImGui::IsKeyPressed(GLFW_KEY_1 + i, false)) work.orbit.go_to(views[i]);
  if (ImGui::IsKeyPressed(GLFW_KEY_F, false)) work.orbit.go_to("front");
  if (ImGui::IsKeyPressed(GLFW_KEY_V, false)) screen.tool = Tool::turn;
  if (ImGui::IsKeyPressed(GLFW_KEY_P, false)) screen.tool = Tool::pull;
  Layers& layers = work.settings.layers;
  for (const auto& [key, layer] : {std::pair(GLFW_KEY_S, &layers.skin),
                                   {GLFW_KEY_M, &layers.muscles},
                                   {GLFW_KEY_K, &layers.skull},
                                   {GLFW_KEY_L, &layers.landmarks}})
    if (ImGui::IsKeyPressed(key, false)) *layer = !*layer;
  if (layers.skin && layers.has_depth() && layers.skin_opacity > 0.99) layers.skin_opacity = 0.35;
  if (!layers.has_depth()) layers.skin_opacity = 1.0;
}

void act_on_timeline(Workspace& work) {
  if (!work.take) return;
  Playback& playback = work.playback;
  const double frame = 1.0 / 60.0, length = work.timeline_length();
  const TakeChoice& choice = work.state().take;
  if (ImGui::IsKeyPressed(GLFW_KEY_SPACE, false)) playback.is_playing = !playback.is_playing;
  if (ImGui::IsKeyPressed(GLFW_KEY_HOME, false)) playback.time = choice.begin;
  if (ImGui::IsKeyPressed(GLFW_KEY_END, false)) playback.time = choice.end < 0.0 ? length : choice.end;
  if (ImGui::IsKeyPressed(GLFW_KEY_LEFT)) playback.time = std::max(playback.time - frame, 0.0);
  if (ImGui::IsKeyPressed(GLFW_KEY_RIGHT)) playback.time = std::min(playback.time + frame, length);
}

}  // namespace

void act_on_keys(Workspace& work, Screen& screen) {
  const ImGuiIO& io = ImGui::GetIO();
  if (io.WantTextInput || screen.browser.is_open()) return;
  if (ImGui::IsKeyPressed(GLFW_KEY_F1, false)) screen.shows_help = true;
  if (io.KeyCtrl) {
    if (ImGui::IsKeyPressed(GLFW_KEY_Z)) io.KeyShift ? work.redo() : work.undo();
    if (ImGui::IsKeyPressed(GLFW_KEY_Y)) work.redo();
    if (ImGui::IsKeyPressed(GLFW_KEY_O, false)) ask_to_open(work, screen);
    if (ImGui::IsKeyPressed(GLFW_KEY_S, false) && work.rig) ask_to_save_rig(work, screen);
    return;
  }
  if (!work.rig || ImGui::IsPopupOpen("", ImGuiPopupFlags_AnyPopupId)) return;
  if (ImGui::IsKeyPressed(GLFW_KEY_N, false)) work.clear_pose();
  if (ImGui::IsKeyPressed(GLFW_KEY_R, false)) work.rebuild();
  if (ImGui::IsKeyPressed(GLFW_KEY_X, false)) work.settings.is_symmetric = !work.settings.is_symmetric;
  act_on_views(work, screen);
  act_on_timeline(work);
}

}  // namespace fascia::app
