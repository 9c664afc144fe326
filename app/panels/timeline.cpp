#include <algorithm>
#include <cmath>

#include "app/panels/screen.h"
#include "app/window/icons.h"
#include "app/window/theme.h"
#include "app/window/widgets.h"

namespace fascia::app {

namespace {

std::string clock_text(double seconds) {
  char text[32];
  std::snprintf(text, sizeof text, "%d:%05.2f", static_cast<int>(seconds / 60.0), std::fmod(seconds, 60.0));
  return text;
}

/// A second's ticks that are at least forty pixels apart.
double tick_step(double pixels_a_second) {
  for (const double step : {0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 60.0, 120.0, 300.0, 600.0})
    if (step * pixels_a_second > 46.0) return step;
  return 1800.0;
}

void show_track(Workspace& work, float width, float height) {
  const Palette& p = palette();
  const double duration = std::max(work.timeline_length(), 1e-3);
  const ImVec2 at = ImGui::GetCursorScreenPos();
  ImDrawList* list = ImGui::GetWindowDrawList();
  const auto x_of = [&](double seconds) {
    return at.x + width * static_cast<float>(std::clamp(seconds / duration, 0.0, 1.0));
  };
  const double begin = work.state().take.begin, end = work.timeline_end();
  list->AddRectFilled(at, {at.x + width, at.y + height}, colour_of(p.raised), scaled(6));
  list->AddRectFilled({x_of(begin), at.y}, {x_of(end), at.y + height}, colour_of(p.accent, 0.16F), scaled(6));
  ImGui::PushFont(fonts().small);
  const double step = tick_step(static_cast<double>(width) / duration);
  for (double tick = 0.0; tick <= duration; tick += step) {
    const float x = x_of(tick);
    list->AddLine({x, at.y + height - scaled(6)}, {x, at.y + height}, colour_of(p.faint, 0.6F));
    char text[24];
    std::snprintf(text, sizeof text, "%.4g", tick);
    if (x + scaled(30) < at.x + width)
      list->AddText({x + scaled(3), at.y + height - scaled(17)}, colour_of(p.faint, 0.8F), text);
  }
  ImGui::PopFont();
  // The trim's handles lie over the track and take the mouse first.
  static int held = -1;
  for (const int side : {0, 1}) {
    const float x = x_of(side == 0 ? begin : end);
    list->AddRectFilled({x - scaled(2.5F), at.y}, {x + scaled(2.5F), at.y + height}, colour_of(p.accent),
                        scaled(2));
    ImGui::SetCursorScreenPos({x - scaled(6), at.y});
    ImGui::InvisibleButton(side == 0 ? "Trim begin" : "Trim end", {scaled(12), height});
    ui::note(side == 0 ? "Trim begin" : "Trim end");
    if (ImGui::IsItemHovered() || ImGui::IsItemActive()) ImGui::SetMouseCursor(ImGuiMouseCursor_ResizeEW);
    if (ImGui::IsItemActive()) {
      held = side;
      const double seconds =
          std::clamp(static_cast<double>((ImGui::GetIO().MousePos.x - at.x) / width), 0.0, 1.0) * duration;
      DocumentState next = work.state();
      const double least = 0.05;  // seconds
      if (side == 0)
        next.take.begin = std::min(seconds, end - least) < 0.0 ? 0.0 : std::min(seconds, end - least);
      else
        next.take.end =
            std::max(seconds, begin + least) >= duration ? -1.0 : std::max(seconds, begin + least);
      work.commit(std::move(next), "Trim the recording", "trim");
    } else if (held == side && ImGui::IsItemDeactivated()) {
      held = -1;
      work.seal();
    }
  }
  ImGui::SetCursorScreenPos(at);
  ImGui::InvisibleButton("Track", {width, height});
  ui::note("Track");
  if (ImGui::IsItemActive()) {
    work.playback.time =
        std::clamp(static_cast<double>((ImGui::GetIO().MousePos.x - at.x) / width), 0.0, 1.0) * duration;
    work.playback.is_playing = false;
  }
  const float head = x_of(work.playback.time);
  list->AddLine({head, at.y - scaled(3)}, {head, at.y + height}, colour_of(p.text), scaled(1.6F));
  list->AddTriangleFilled({head - scaled(5), at.y - scaled(4)}, {head + scaled(5), at.y - scaled(4)},
                          {head, at.y + scaled(4)}, colour_of(p.text));
}

/// Gravity, the head's shake, recordings: in a row, or one below the other.
void show_motion(Workspace& work, Screen& screen, bool is_column) {
  const char* const gravities[] = {"Upright", "Lying", "Face down", "Upside down"};
  int gravity = static_cast<int>(work.gravity);
  ImGui::SetNextItemWidth(scaled(120));
  if (ImGui::Combo("##gravity", &gravity, gravities, 4)) work.gravity = static_cast<Gravity>(gravity);
  ui::tooltip("Which way gravity pulls the face");
  ui::note("Gravity");
  if (!is_column) ImGui::SameLine();
  if (ui::button("Shake head")) work.shake_head();
  if (!is_column) ImGui::SameLine();
  if (ui::button("Load take")) {
    ask_for_take(work, screen);
    if (is_column) ImGui::CloseCurrentPopup();
  }
  if (!work.take) return;
  if (!is_column) ImGui::SameLine();
  if (ui::button("Add layer")) {
    ask_for_layer(work, screen);
    if (is_column) ImGui::CloseCurrentPopup();
  }
  ui::tooltip("Another recording, added to this one");
}

}  // namespace

void show_timeline(Workspace& work, Screen& screen, const Area& area) {
  const Palette& p = palette();
  begin_area("##timeline", area, p.panel, {scaled(14), scaled(8)});
  Playback& playback = work.playback;
  const bool has_take = work.take != nullptr;
  if (icon_button("Play", playback.is_playing ? "pause" : "play",
                  playback.is_playing ? "Pause (Space)" : "Play (Space)", false, has_take)) {
    if (!playback.is_playing && playback.time >= work.timeline_end() - 1e-3)
      playback.time = work.state().take.begin;
    playback.is_playing = !playback.is_playing;
  }
  ImGui::SameLine(0, scaled(2));
  if (icon_button("Loop", "loop", "Play over and over", has_take && work.state().take.loops, has_take)) {
    DocumentState next = work.state();
    next.take.loops = !next.take.loops;
    work.commit(std::move(next), "Loop");
  }
  ImGui::SameLine(0, scaled(2));
  if (icon_button("Record", "record",
                  has_take ? "Record what the sliders do as a layer over this recording"
                           : "Record what the sliders do as a new recording",
                  playback.is_recording, work.rig.has_value())) {
    if (playback.is_recording)
      work.stop_recording();
    else
      work.start_recording();
  }
  ImGui::SameLine(0, scaled(10));
  ImGui::AlignTextToFramePadding();
  if (playback.is_recording) {
    ImGui::TextColored(p.bad, "Recording %.1f s", playback.recorded_seconds);
  } else if (has_take) {
    ImGui::Text("%s / %s", clock_text(playback.time).c_str(), clock_text(work.timeline_length()).c_str());
    ImGui::SameLine(0, scaled(14));
    ImGui::TextColored(p.faint, "%s",
                       ui::shortened(work.take->file().filename().string(), scaled(220)).c_str());
  } else {
    ImGui::TextColored(p.faint, "%s",
                       ui::shortened("Drop a recording here: CSV, JSON or GLB",
                                     area.width - scaled(area.width > scaled(640) ? 540.0F : 210.0F))
                           .c_str());
  }
  const float motion = scaled(has_take ? 434.0F : 346.0F);
  if (area.width > motion + scaled(294)) {
    ImGui::SameLine(area.width - motion);
    show_motion(work, screen, false);
  } else {
    ImGui::SameLine(area.width - scaled(72));
    if (ui::button("More")) ImGui::OpenPopup("##motion");
    if (ImGui::BeginPopup("##motion")) {
      show_motion(work, screen, true);
      ImGui::EndPopup();
    }
  }
  if (has_take) {
    show_track(work, area.width - scaled(28), scaled(30));
    ImGui::SetCursorPosY(scaled(88));
    show_layers(work, area.width - scaled(28));
  }
  end_area();
}

}  // namespace fascia::app
